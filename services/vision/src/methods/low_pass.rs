//! Low-pass filters (thesis 2.3, eq. 2.9): each pixel becomes a weighted mean of those around it.

use std::num::NonZeroU16;

use super::border::Border;
use super::plane::Plane;

/// How many standard deviations from its middle a Gaussian is cut off, as SciPy does it.
const GAUSSIAN_REACH: f32 = 4.0;

/// The mean over a window of `width` × `height` pixels (eq. 2.9 is 3 × 3). A window of even size has one pixel more
/// before its middle than after it.
#[must_use]
pub fn low_pass(plane: &Plane, width: NonZeroU16, height: NonZeroU16, border: Border) -> Plane {
    let rows = mean_weights(height);
    separable(plane, &mean_weights(width), &rows, border)
}

/// Smoothing by a Gaussian of standard deviation `sigma_px`; none where that is not positive.
#[must_use]
pub fn gaussian(plane: &Plane, sigma_px: f32, border: Border) -> Plane {
    if sigma_px.is_nan() || sigma_px <= 0.0 {
        return plane.clone();
    }
    let weights = gaussian_weights(sigma_px, plane.width().max(plane.height()));
    separable(plane, &weights, &weights, border)
}

fn mean_weights(window: NonZeroU16) -> Vec<f32> {
    vec![1.0 / f32::from(window.get()); usize::from(window.get())]
}

/// Weights that add up to one. No wider than twice the picture: beyond that a border has nothing new.
fn gaussian_weights(sigma_px: f32, most: u32) -> Vec<f32> {
    let radius = (GAUSSIAN_REACH * sigma_px + 0.5).floor().min(most as f32) as i32;
    let weight = |at: i32| (-0.5 * (f64::from(at) / f64::from(sigma_px)).powi(2)).exp();
    let total: f64 = (-radius..=radius).map(weight).sum();
    (-radius..=radius).map(|at| (weight(at) / total) as f32).collect()
}

/// Correlation with a window that is a product of weights along x and along y.
pub(super) fn separable(plane: &Plane, along_x: &[f32], along_y: &[f32], border: Border) -> Plane {
    let across = sum_rows(plane, along_y, border);
    let mut result = Plane::zeros(plane.size());
    let places = border.places(plane.width(), along_x.len() as u32);
    let mut extended = vec![0.0; places.len()];
    for y in 0..plane.height() {
        let row = across.row(y);
        for (value, place) in extended.iter_mut().zip(&places) {
            *value = place.map_or(0.0, |x| row[x]);
        }
        for (&weight, shift) in along_x.iter().zip(0..) {
            add_weighted(result.row_mut(y), &extended[shift..], weight);
        }
    }
    result
}

/// Weighted sums of each pixel and those above and below it.
fn sum_rows(plane: &Plane, weights: &[f32], border: Border) -> Plane {
    let places = border.places(plane.height(), weights.len() as u32);
    let mut result = Plane::zeros(plane.size());
    for y in 0..plane.height() {
        for (&weight, place) in weights.iter().zip(&places[y as usize..]) {
            if let Some(from) = *place {
                add_weighted(result.row_mut(y), plane.row(from as u32), weight);
            }
        }
    }
    result
}

fn add_weighted(sums: &mut [f32], values: &[f32], weight: f32) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SizePx;
    use crate::methods::reference::{any_border, any_plane};
    use proptest::prelude::*;

    fn slowly(plane: &Plane, width: u16, height: u16, border: Border) -> Plane {
        Plane::from_fn(plane.size(), |x, y| {
            let mut sum = 0.0;
            for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
                let x = border.pixel(i64::from(x) + i64::from(column) - i64::from(width / 2), plane.width());
                let y = border.pixel(i64::from(y) + i64::from(row) - i64::from(height / 2), plane.height());
                sum += x.zip(y).map_or(0.0, |(x, y)| f64::from(plane.get(x as u32, y as u32)));
            }
            (sum / f64::from(width) / f64::from(height)) as f32
        })
    }

    #[test]
    fn smoothing_keeps_a_flat_picture() {
        let flat = Plane::from_fn(SizePx { width: 9, height: 1 }, |_, _| 7.0);
        for sigma_px in [-1.0, 0.0, f32::NAN, 0.3, 2.0, 1e9] {
            for &value in gaussian(&flat, sigma_px, Border::Mirror).values() {
                assert!((value - 7.0).abs() < 1e-4, "{value} with sigma {sigma_px}");
            }
        }
    }

    proptest! {
        #[test]
        fn the_mean_is_that_of_the_window(
            plane in any_plane(12), width in 1u16..7, height in 1u16..7, border in any_border(),
        ) {
            let sides = [width, height].map(|side| NonZeroU16::new(side).unwrap());
            let (fast, slow) = (low_pass(&plane, sides[0], sides[1], border), slowly(&plane, width, height, border));
            prop_assert_eq!(fast.size(), slow.size());
            for (fast, slow) in fast.values().iter().zip(slow.values()) {
                prop_assert!((fast - slow).abs() < 1e-3, "{} is not {}", fast, slow);
            }
        }
    }
}
