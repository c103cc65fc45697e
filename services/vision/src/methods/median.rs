//! The median filter (thesis 2.3): each pixel becomes the median of a window around it, so single wrong pixels vanish
//! and straight edges stay.

use std::num::NonZeroU16;

use super::border::Border;
use super::plane::Plane;

/// The median over a window of `width` × `height` pixels. Of an even number of pixels it is the mean of the middle two,
/// as MATLAB has it (Fig 2.1 uses 2 × 2). A window of even size has one pixel more before its middle than after it.
#[must_use]
pub fn median(plane: &Plane, width: NonZeroU16, height: NonZeroU16, border: Border) -> Plane {
    let (window_width, window_height) = (usize::from(width.get()), usize::from(height.get()));
    let columns = border.places(plane.width(), width.get().into());
    let rows = border.places(plane.height(), height.get().into());
    // The rows under the window, continued beyond the picture's edges.
    let mut strips = vec![vec![0.0; columns.len()]; window_height];
    let mut window = Vec::with_capacity(window_width * window_height);
    let mut result = Plane::zeros(plane.size());
    for y in 0..plane.height() {
        for (strip, row) in strips.iter_mut().zip(&rows[y as usize..]) {
            let row = row.map(|row| plane.row(row as u32));
            for (value, column) in strip.iter_mut().zip(&columns) {
                *value = row.zip(*column).map_or(0.0, |(row, x)| row[x]);
            }
        }
        for (x, value) in result.row_mut(y).iter_mut().enumerate() {
            window.clear();
            strips.iter().for_each(|strip| window.extend_from_slice(&strip[x..x + window_width]));
            *value = middle(&mut window);
        }
    }
    result
}

/// The median of at least one value.
fn middle(values: &mut [f32]) -> f32 {
    let (half, odd) = (values.len() / 2, !values.len().is_multiple_of(2));
    let (below, &mut upper, _) = values.select_nth_unstable_by(half, f32::total_cmp);
    if odd {
        return upper;
    }
    let lower = below.iter().copied().max_by(f32::total_cmp).unwrap_or(upper);
    (lower + upper) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SizePx;
    use crate::methods::reference::{any_border, any_plane};
    use proptest::prelude::*;

    #[test]
    fn a_single_wrong_pixel_vanishes_and_an_edge_stays() {
        let edge = Plane::from_fn(SizePx { width: 8, height: 6 }, |x, _| if x < 4 { 10.0 } else { 200.0 });
        let mut noisy = edge.clone();
        noisy.row_mut(3)[1] = 255.0;
        let side = NonZeroU16::new(3).unwrap();
        assert_eq!(median(&noisy, side, side, Border::Nearest), edge);
        assert!(median(&Plane::default(), side, side, Border::Zero).is_empty());
    }

    proptest! {
        #[test]
        fn each_pixel_is_the_middle_of_its_window(
            plane in any_plane(9), width in 1u16..6, height in 1u16..6, border in any_border(),
        ) {
            let sides = [width, height].map(|side| NonZeroU16::new(side).unwrap());
            let slow = Plane::from_fn(plane.size(), |x, y| {
                let level = |column: u16, row: u16| {
                    let x = i64::from(x) + i64::from(column) - i64::from(width / 2);
                    let y = i64::from(y) + i64::from(row) - i64::from(height / 2);
                    let place = border.pixel(x, plane.width()).zip(border.pixel(y, plane.height()));
                    place.map_or(0.0, |(x, y)| plane.get(x as u32, y as u32))
                };
                let places = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
                let mut levels: Vec<f32> = places.map(|(column, row)| level(column, row)).collect();
                levels.sort_by(f32::total_cmp);
                (levels[(levels.len() - 1) / 2] + levels[levels.len() / 2]) / 2.0
            });
            prop_assert_eq!(median(&plane, sides[0], sides[1], border), slow);
        }
    }
}
