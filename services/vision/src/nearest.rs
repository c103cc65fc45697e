//! How near a frame came to a match: the one question that must look at every window, asked only by those who explain
//! a miss.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::{ColorStats, Landmark};
use crate::outcome::{NearestMatch, Statistic};
use crate::statistics::WindowSums;

/// The window in `region` (all of the frame for `None`) whose worst statistic, measured in tolerances, is the least far
/// off, over all shades. `None` where no window fits. Takes some 50 ms for a frame of 640×480.
#[must_use]
pub fn nearest_match(frame: &Frame, landmark: &Landmark, region: Option<RectPx>) -> Option<NearestMatch> {
    let region = region.unwrap_or(RectPx::whole(frame.size())).clipped_to(frame.size())?;
    let grid = DoubledGrid::new(region, landmark.window_px)?;
    let mut columns = ColumnSums::above(frame, &grid);
    let mut best: Option<NearestMatch> = None;
    for y in 0..grid.mask_height() {
        columns.descend(y);
        for x in 0..grid.mask_width() {
            let observed = columns.window(x).stats();
            for shade in &landmark.shades {
                let (worst, excess) = worst_statistic(&observed, shade, &landmark.tolerance);
                if best.is_none_or(|best| excess < best.excess) {
                    let at = grid.frame_from_mask(f64::from(x), f64::from(y));
                    best = Some(NearestMatch { at, observed, worst, excess });
                }
            }
        }
    }
    best
}

/// The statistic of `observed` that is furthest from `expected`, and by how many tolerances.
#[must_use]
pub fn worst_statistic(
    observed: &ColorStats,
    expected: &ColorStats,
    tolerance: &ColorStats,
) -> (Statistic, f32) {
    // A tolerance of nothing is met exactly or missed by any number of tolerances.
    let excess = |observed: f32, expected: f32, tolerance: f32| {
        if observed == expected { 0.0 } else { (observed - expected).abs() / tolerance.max(0.0) }
    };
    let statistics = (0..3).flat_map(|channel| {
        let at = usize::from(channel);
        [
            (Statistic::Mean(channel), excess(observed.mean[at], expected.mean[at], tolerance.mean[at])),
            (
                Statistic::Variance(channel),
                excess(observed.variance[at], expected.variance[at], tolerance.variance[at]),
            ),
        ]
    });
    let first = (Statistic::Mean(0), f32::NEG_INFINITY);
    statistics.fold(first, |worst, next| if next.1 > worst.1 { next } else { worst })
}

/// Sums over the rows of the windows of one mask row, column by column: levels and their squares, R, G, B.
struct ColumnSums<'a> {
    frame: &'a Frame,
    grid: &'a DoubledGrid,
    columns: Vec<[u64; 6]>,
    /// Sums of all columns before each.
    before: Vec<[u64; 6]>,
}

impl<'a> ColumnSums<'a> {
    /// Before the first row.
    fn above(frame: &'a Frame, grid: &'a DoubledGrid) -> Self {
        let width = grid.region().width as usize;
        Self { frame, grid, columns: vec![[0; 6]; width], before: vec![[0; 6]; width + 1] }
    }

    /// Goes on from row `y - 1`, or from above the first row, to row `y`.
    fn descend(&mut self, y: u32) {
        let side = self.grid.window().height;
        if y == 0 {
            for row in DoubledGrid::pixels_under(0, side) {
                let samples = u64::from(DoubledGrid::samples_on(row, 0, side));
                self.add(row, |sum, level| sum + samples * level);
            }
        } else {
            self.add(DoubledGrid::pixels_under(y, side).end - 1, |sum, level| sum + level);
            self.add(DoubledGrid::pixels_under(y - 1, side).start, |sum, level| sum - level);
        }
        for (at, column) in self.columns.iter().enumerate() {
            self.before[at + 1] = std::array::from_fn(|sum| self.before[at][sum] + column[sum]);
        }
    }

    fn add(&mut self, row: u32, with: impl Fn(u64, u64) -> u64) {
        let region = self.grid.region();
        let pixels = self.frame.row(region.y + row).as_chunks::<3>().0;
        for (column, pixel) in self.columns.iter_mut().zip(&pixels[region.x as usize..]) {
            for channel in 0..3 {
                let level = u64::from(pixel[channel]);
                column[channel] = with(column[channel], level);
                column[3 + channel] = with(column[3 + channel], level * level);
            }
        }
    }

    /// The sums of the window at column `x` of the mask.
    fn window(&self, x: u32) -> WindowSums {
        let pixels = DoubledGrid::pixels_under(x, self.grid.window().width);
        let side = self.grid.window().width;
        let whole = DoubledGrid::first_whole_pixel(x);
        let whole = whole as usize..(whole + DoubledGrid::whole_pixels(side)) as usize;
        let ends = [pixels.start as usize, pixels.end as usize - 1];
        let sum = |of: usize| {
            let mut sum = 2 * (self.before[whole.end][of] - self.before[whole.start][of]);
            let mut counted = None;
            for end in ends.into_iter().filter(|end| !whole.contains(end)) {
                if counted.replace(end) != Some(end) {
                    sum += u64::from(DoubledGrid::samples_on(end as u32, x, side)) * self.columns[end][of];
                }
            }
            sum
        };
        WindowSums {
            samples: self.grid.samples(),
            sum: [sum(0), sum(1), sum(2)],
            sum_of_squares: [sum(3), sum(4), sum(5)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landmark::{Digest, ShapeClass, WindowPx};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn windows_are_what_summing_each_gives(
            (width, height) in (1u16..9, 1u16..9), levels in prop::collection::vec(any::<u8>(), 3 * 9 * 7),
        ) {
            let frame = Frame::from_rgb(9, 7, levels).unwrap();
            let region = RectPx { x: 2, y: 1, width: 7, height: 6 };
            let grid = DoubledGrid::new(region, WindowPx { width, height }).unwrap();
            let mut columns = ColumnSums::above(&frame, &grid);
            for y in 0..grid.mask_height() {
                columns.descend(y);
                for x in 0..grid.mask_width() {
                    prop_assert_eq!(columns.window(x), WindowSums::at(&frame, &grid, x, y));
                }
            }
        }
    }

    #[test]
    fn the_nearest_window_and_its_worst_statistic_are_named() {
        let mut frame = Frame::from_rgb(20, 10, vec![40; 600]).unwrap();
        for (x, y) in (4..8).flat_map(|y| (10..14).map(move |x| (x, y))) {
            frame.rgb_mut()[3 * (20 * y + x)] = 120;
        }
        let landmark = Landmark {
            id: "red".into(),
            revision: 1,
            window_px: WindowPx::square(8),
            shades: vec![ColorStats { mean: [150.0, 40.0, 40.0], variance: [0.0; 3] }],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Any,
            size_m: None,
            digest: Digest::default(),
        };
        let nearest = nearest_match(&frame, &landmark, None).unwrap();
        assert_eq!((nearest.worst, nearest.excess), (Statistic::Mean(0), 2.0));
        assert_eq!((nearest.at.x, nearest.at.y), (12.0, 6.0));
        let nowhere = RectPx { x: 20, y: 0, width: 9, height: 9 };
        assert_eq!(nearest_match(&frame, &landmark, Some(nowhere)), None);
    }
}
