//! Interpolation (thesis 2.4): values between pixels, and pictures of another resolution.

use super::border::Border;
use super::plane::Plane;
use crate::geometry::{PointPx, SizePx};

/// Nobody looks further beyond the edge, and here whole numbers still hold it.
const FAR: f32 = 1e9;

/// How a value between pixels is estimated from those around it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the pixel that the point lies in.
    Nearest,
    /// v = ax + by + cxy + d through the four pixels around it (eq. 2.10).
    #[default]
    Bilinear,
    /// The sixteen-coefficient surface of eq. 2.11 over the sixteen pixels around it: it passes through the inner four
    /// and has there the slopes that their neighbours give. That is Keys' cubic convolution with a = −½, as in MATLAB and
    /// scikit-image; OpenCV takes a = −¾.
    Bicubic,
}

impl Interpolation {
    /// The value of `plane` at a point in pixels, corner origin: the middle of the first pixel is (0.5, 0.5). Beyond the
    /// edge `border` holds. 0 for an empty plane or a point that is not finite.
    #[must_use]
    pub fn sample(self, plane: &Plane, at: PointPx, border: Border) -> f32 {
        if plane.is_empty() || !at.x.is_finite() || !at.y.is_finite() {
            return 0.0;
        }
        let (columns, rows) = (self.taps(at.x), self.taps(at.y));
        let mut value = 0.0;
        for (place, weight) in rows.iter() {
            let Some(y) = border.pixel(place, plane.height()) else { continue };
            let row = plane.row(y as u32);
            let along = columns
                .iter()
                .map(|(place, weight)| border.pixel(place, plane.width()).map_or(0.0, |x| weight * row[x]));
            value += weight * along.sum::<f32>();
        }
        value
    }

    /// `plane` at another resolution: each new pixel takes the value at its middle. Beyond the edge the nearest pixel holds.
    /// Nothing is averaged, so a picture that shrinks to less than half should be smoothed before.
    #[must_use]
    pub fn resized(self, plane: &Plane, size: SizePx) -> Plane {
        if plane.is_empty() {
            return Plane::zeros(size);
        }
        let columns = self.all_taps(plane.width(), size.width);
        let rows = self.all_taps(plane.height(), size.height);
        let mut widened = Plane::zeros(SizePx { width: size.width, height: plane.height() });
        for y in 0..plane.height() {
            let from = plane.row(y);
            for (value, taps) in widened.row_mut(y).iter_mut().zip(&columns) {
                *value = taps.iter().map(|(place, weight)| weight * from[place as usize]).sum();
            }
        }
        let mut result = Plane::zeros(size);
        for (y, taps) in (0..size.height).zip(&rows) {
            for (place, weight) in taps.iter() {
                let row = result.row_mut(y).iter_mut().zip(widened.row(place as u32));
                row.for_each(|(value, &from)| *value += weight * from);
            }
        }
        result
    }

    /// The taps of every pixel along one side, as pixels that exist.
    fn all_taps(self, from: u32, to: u32) -> Vec<Taps> {
        let scale = f64::from(from) / f64::from(to.max(1));
        let taps = |at: u32| self.taps_within(((f64::from(at) + 0.5) * scale) as f32, from);
        (0..to).map(taps).collect()
    }

    fn taps_within(self, at: f32, length: u32) -> Taps {
        let mut taps = self.taps(at);
        for place in &mut taps.places[..taps.count] {
            *place = (*place).clamp(0, i64::from(length) - 1);
        }
        taps
    }

    /// The pixels along one side that count at `at`, with their weights.
    fn taps(self, at: f32) -> Taps {
        let at = at.clamp(-FAR, FAR);
        if self == Self::Nearest {
            return Taps { places: [at.floor() as i64, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0], count: 1 };
        }
        let first = (at - 0.5).floor();
        let (t, first) = (at - 0.5 - first, first as i64);
        if self == Self::Bilinear {
            return Taps { places: [first, first + 1, 0, 0], weights: [1.0 - t, t, 0.0, 0.0], count: 2 };
        }
        let (t2, t3) = (t * t, t * t * t);
        let weights = [
            -0.5 * t + t2 - 0.5 * t3,
            1.0 - 2.5 * t2 + 1.5 * t3,
            0.5 * t + 2.0 * t2 - 1.5 * t3,
            -0.5 * t2 + 0.5 * t3,
        ];
        Taps { places: [first - 1, first, first + 1, first + 2], weights, count: 4 }
    }
}

/// Up to four pixels along one side with their weights.
#[derive(Clone, Copy, Debug)]
struct Taps {
    places: [i64; 4],
    weights: [f32; 4],
    count: usize,
}

impl Taps {
    fn iter(&self) -> impl Iterator<Item = (i64, f32)> {
        self.places.iter().copied().zip(self.weights).take(self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::reference::{any_border, any_plane, assert_close};
    use proptest::prelude::*;

    const ALL: [Interpolation; 3] = [Interpolation::Nearest, Interpolation::Bilinear, Interpolation::Bicubic];

    #[test]
    fn what_a_polynomial_gives_is_given_back() {
        let size = SizePx { width: 9, height: 8 };
        let bilinear = |x: f32, y: f32| 3.0 + 2.0 * x - y + 0.5 * x * y;
        let quadratic = |x: f32, y: f32| bilinear(x, y) + 0.25 * x * x - 0.5 * y * y;
        let sampled =
            |f: &dyn Fn(f32, f32) -> f32| Plane::from_fn(size, |x, y| f(x as f32 + 0.5, y as f32 + 0.5));
        for at in [PointPx::new(2.5, 3.5), PointPx::new(3.1, 4.7), PointPx::new(5.99, 2.01)] {
            let value = Interpolation::Bilinear.sample(&sampled(&bilinear), at, Border::Zero);
            assert!((value - bilinear(at.x, at.y)).abs() < 1e-3);
            let value = Interpolation::Bicubic.sample(&sampled(&quadratic), at, Border::Zero);
            assert!((value - quadratic(at.x, at.y)).abs() < 1e-3);
        }
    }

    #[test]
    fn nothing_comes_of_nothing() {
        for method in ALL {
            assert_eq!(method.sample(&Plane::default(), PointPx::new(1.0, 1.0), Border::Wrap), 0.0);
            let one = Plane::new(1, 1, vec![5.0]).unwrap();
            assert_eq!(method.sample(&one, PointPx::new(f32::NAN, 0.0), Border::Nearest), 0.0);
            assert_eq!(method.sample(&one, PointPx::new(-1e30, 1e30), Border::Nearest), 5.0);
            assert!(method.resized(&one, SizePx::default()).is_empty());
            assert_eq!(
                method.resized(&Plane::default(), SizePx { width: 2, height: 1 }).values(),
                [0.0, 0.0]
            );
        }
    }

    proptest! {
        #[test]
        fn at_the_middles_of_pixels_are_their_values(plane in any_plane(9), border in any_border()) {
            for method in ALL {
                let again = Plane::from_fn(plane.size(), |x, y| {
                    method.sample(&plane, PointPx::new(x as f32 + 0.5, y as f32 + 0.5), border)
                });
                assert_close(&again, &plane, 1e-3);
                assert_close(&method.resized(&plane, plane.size()), &plane, 1e-3);
            }
        }

        #[test]
        fn a_resized_picture_holds_samples(plane in any_plane(9), width in 1u32..20, height in 1u32..20) {
            prop_assume!(!plane.is_empty());
            let scale = (plane.width() as f32 / width as f32, plane.height() as f32 / height as f32);
            for method in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let sampled = Plane::from_fn(SizePx { width, height }, |x, y| {
                    let at = PointPx::new((x as f32 + 0.5) * scale.0, (y as f32 + 0.5) * scale.1);
                    method.sample(&plane, at, Border::Nearest)
                });
                assert_close(&method.resized(&plane, sampled.size()), &sampled, 0.01);
            }
        }
    }
}
