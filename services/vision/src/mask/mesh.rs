//! Where sub-blocks are looked at, and what their averages prove.
//!
//! Let a window of n samples have mean μ and variance σ², and let k of its samples have mean μₖ. The variance between
//! those k and the rest is part of σ², so (μₖ − μ)² ≤ σ² (n − k)/k. A window that matches has μ and σ² inside known
//! bounds; hence a sub-block whose mean lies outside bounds that are wider by √(σ²ₘₐₓ (n − k)/k) proves that no window
//! around it matches.
//!
//! Every window of height h covers s = ⌊(h − 1)/2⌋ pixel rows in full, wherever it starts, so of sub-blocks r rows high,
//! one every s − r + 1 rows, one lies in it; likewise along x, where one begins at every pixel. Means are taken by
//! rounding byte averages of pairs, pairs of pairs … : never too small, and too large by at most 1/2 for each halving.
//!
//! A window of even height that starts on the second sample of a pixel is the mean of the two that start on the first
//! samples of that pixel and the next, and these cover h/2 rows in full. Its variance is at least the mean of theirs, so
//! the mean of their sub-blocks keeps to its bounds, and of their sub-blocks one is not above and one not below them.
//! Where the extremes of neighbouring sub-blocks are compared, not each by itself, s = h/2 will therefore do.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::landmark::WindowPx;
use crate::statistics::{Acceptance, Bounds};

/// Halvings that give the largest side of a sub-block: 2³ pixels.
const MOST_HALVINGS: u32 = 3;

/// Cells of a survey are about so many rows of pixels high.
pub(super) const CELL_ROWS: u32 = 8;

/// What is looked at, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Look {
    /// Sub-blocks of a single row, each by itself.
    Rows,
    /// The extremes over a cell of sub-blocks of several rows.
    SubBlocks,
    /// The extremes over a cell of whole windows.
    Windows,
}

/// The sub-blocks for one window, and the bands of them that make a row of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mesh {
    look: Look,
    sub_block: SubBlock,
    row_step: u32,
    /// Bands in a row of cells.
    together: u32,
}

impl Mesh {
    /// Sub-blocks of a single row, the cheapest to look at; `None` for windows so small that they may cover no pixel in
    /// full.
    pub(super) fn of_single_rows(window: WindowPx) -> Option<Self> {
        let whole = |side| Some(DoubledGrid::whole_pixels(side)).filter(|&pixels| pixels > 0);
        let (width, height) = (whole(window.width)?, whole(window.height)?);
        let sub_block = SubBlock { width_px: side_within(width), height_px: 1 };
        Some(Self { look: Look::Rows, sub_block, row_step: height, together: 1 })
    }

    /// Sub-blocks of several rows, whose extremes over a cell are looked at: they see nearly every pixel, and prove more.
    pub(super) fn of_sub_blocks(window: WindowPx) -> Option<Self> {
        let (width, height) = aligned(window)?;
        let sub_block = SubBlock { width_px: side_within(width), height_px: side_within(height) };
        let row_step = height - sub_block.height_px + 1;
        let together = CELL_ROWS.div_ceil(row_step);
        Some(Self { look: Look::SubBlocks, sub_block, row_step, together })
    }

    /// Whole windows, whose extremes over a cell are looked at; `None` unless all windows are means of those that start
    /// on the first samples of pixels.
    pub(super) fn of_windows(window: WindowPx) -> Option<Self> {
        let even = window.width.is_multiple_of(2) && window.height.is_multiple_of(2);
        let (width_px, height_px) = aligned(window).filter(|_| even)?;
        let sub_block = SubBlock { width_px, height_px };
        Some(Self { look: Look::Windows, sub_block, row_step: 1, together: CELL_ROWS })
    }

    /// What is averaged: sub-blocks, or whole windows.
    pub(super) fn sub_block(self) -> SubBlock {
        self.sub_block
    }

    /// Whether it looks at whole windows.
    pub(super) fn is_of_windows(self) -> bool {
        self.look == Look::Windows
    }

    /// Byte averages that may belong to a window that matches, R, G, B; `None` where none can.
    pub(super) fn averages(self, accepted: &Acceptance, samples: u32) -> Option<[Bounds<u8>; 3]> {
        match self.look {
            Look::Windows => Some(accepted.levels_around_means(samples)),
            Look::Rows | Look::SubBlocks => self.sub_block.averages(accepted, samples),
        }
    }

    /// The rows of pixels that band `band` looks at.
    pub(super) fn pixel_rows(self, band: u32) -> Range<u32> {
        let first = band * self.row_step;
        first..first + self.sub_block.height_px
    }

    /// The rows of the mask that row `row` of cells decides on.
    pub(super) fn mask_rows(self, row: u32, mask_height: u32) -> Range<u32> {
        let pixels = self.start_pixels(row);
        let rows = match self.look {
            Look::Rows => DoubledGrid::starts_with_first_whole_pixel(pixels),
            Look::SubBlocks | Look::Windows => {
                DoubledGrid::starts_on(pixels.start).start..DoubledGrid::starts_on(pixels.end).start
            }
        };
        rows.start.min(mask_height)..rows.end.min(mask_height)
    }

    /// The rows of pixels where the windows begin that row `row` of cells decides on; those that they cover in full first,
    /// where it looks at single rows.
    pub(super) fn start_pixels(self, row: u32) -> Range<u32> {
        let bands = self.own_bands(row);
        let first = (bands.start * self.row_step + 1).saturating_sub(self.row_step);
        first..(bands.end - 1) * self.row_step + 1
    }

    /// The bands that begin in row `row` of cells.
    fn own_bands(self, row: u32) -> Range<u32> {
        row * self.together..(row + 1) * self.together
    }

    /// The bands that row `row` of cells looks at, as far as they exist: in a survey with the next one, which windows
    /// that start between two pixels cover.
    pub(super) fn bands_seen(self, row: u32) -> Range<u32> {
        let own = self.own_bands(row);
        own.start..own.end + u32::from(self.look != Look::Rows)
    }

    /// Rows of cells.
    pub(super) fn cell_rows(self, region_height: u32) -> u32 {
        self.bands(region_height).div_ceil(self.together)
    }

    /// Number of bands.
    pub(super) fn bands(self, region_height: u32) -> u32 {
        (region_height + 1).saturating_sub(self.sub_block.height_px).div_ceil(self.row_step)
    }
}

/// Width and height in pixels of the windows that start on the first samples of pixels; `None` where one covers no pixel
/// in full.
fn aligned(window: WindowPx) -> Option<(u32, u32)> {
    let pixels = |side| Some(DoubledGrid::aligned_pixels(side)).filter(|&pixels| pixels > 0);
    Some((pixels(window.width)?, pixels(window.height)?))
}

/// Pixels that lie under a window in full; but for whole windows both sides are powers of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SubBlock {
    pub(super) width_px: u32,
    pub(super) height_px: u32,
}

impl SubBlock {
    /// Byte averages that may belong to a window that matches, R, G, B; `None` where none can.
    pub(super) fn averages(self, accepted: &Acceptance, samples: u32) -> Option<[Bounds<u8>; 3]> {
        let (n, k) = (f64::from(samples), self.samples());
        let mut averages = [Bounds { low: 0, high: 0 }; 3];
        for (channel, averages) in averages.iter_mut().enumerate() {
            let largest_variance = accepted.spread[channel].high as f64 / (n * n);
            let wider = (largest_variance * (n - k).max(0.0) / k).sqrt() + ROUNDING;
            let low = (f64::from(accepted.sum[channel].low) / n - wider).ceil().max(0.0);
            let high = f64::from(accepted.sum[channel].high) / n + wider + self.averaging();
            let high = high.floor().min(255.0);
            if low > high {
                return None;
            }
            *averages = Bounds { low: low as u8, high: high as u8 };
        }
        Some(averages)
    }

    /// The most by which byte averages of its halves differ where it belongs to a window that matches, in any channel: the
    /// scatter of the window's n samples about their mean, n σ², is at least that of the halves' means, k/4 times their
    /// squared difference.
    pub(super) fn most_between_halves(self, accepted: &Acceptance, samples: u32) -> u8 {
        let largest = accepted.spread.map(|spread| spread.high).into_iter().max().unwrap_or(0);
        let most = (4.0 * largest as f64 / (f64::from(samples) * self.samples())).sqrt();
        (most + self.averaging() + ROUNDING).min(255.0) as u8
    }

    /// Samples of it, k: each of its pixels is four.
    fn samples(self) -> f64 {
        f64::from(4 * self.width_px * self.height_px)
    }

    /// By how much a byte average may be too large.
    fn averaging(self) -> f64 {
        f64::from(self.width_px.ilog2() + self.height_px.ilog2()) / 2.0
    }
}

/// Sub-blocks so near to each other that every window covers one of them in full, wherever it starts. Each by itself proves
/// something of the windows around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lattice {
    sub_block: SubBlock,
    column_step: u32,
    row_step: u32,
}

impl Lattice {
    /// `None` for windows so small that they may cover no pixel in full.
    pub(super) fn of(window: WindowPx) -> Option<Self> {
        let whole = |side| Some(DoubledGrid::whole_pixels(side)).filter(|&pixels| pixels > 0);
        let (width, height) = (whole(window.width)?, whole(window.height)?);
        let sub_block = SubBlock { width_px: side_within(width), height_px: side_within(height) };
        let (column_step, row_step) = (width - sub_block.width_px + 1, height - sub_block.height_px + 1);
        Some(Self { sub_block, column_step, row_step })
    }

    pub(super) fn sub_block(self) -> SubBlock {
        self.sub_block
    }

    /// So far beyond the columns where windows begin lie the pixels of what [`columns`](Self::columns) gives.
    pub(super) fn reach_px(self) -> u32 {
        self.column_step + self.sub_block.width_px
    }

    /// Pixels from one sub-block to the next.
    pub(super) fn column_step(self) -> u32 {
        self.column_step
    }

    /// From the first to the last sub-block's first column, where every window that begins on one of these columns covers
    /// one of them.
    pub(super) fn columns(self, starts: &Range<u32>) -> Range<u32> {
        places(starts, self.column_step)
    }

    /// The first rows of sub-blocks, likewise.
    pub(super) fn rows(self, starts: &Range<u32>) -> impl Iterator<Item = u32> {
        places(starts, self.row_step).step_by(self.row_step as usize)
    }
}

/// From the first to the last multiple of `step` that comes next from a pixel where windows begin, or from the pixel after
/// it: that is the first one they cover in full when they begin on a pixel's second sample.
fn places(starts: &Range<u32>, step: u32) -> Range<u32> {
    starts.start.next_multiple_of(step)..starts.end.next_multiple_of(step) + 1
}

/// The side of the largest sub-block within so many pixels.
fn side_within(pixels: u32) -> u32 {
    1 << pixels.ilog2().min(MOST_HALVINGS)
}

/// More than all rounding in the few operations above.
const ROUNDING: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every mask row belongs to one row of cells, which sees a band of pixels that its windows cover in full; or, in
        /// a survey and between two pixels, that both of the windows cover that they are the mean of.
        #[test]
        fn every_window_covers_a_sub_block(side in 3u16..60, more in 0u32..70, start in 0u32..200) {
            let height = u32::from(side) + more;
            let mask_height = 2 * height - u32::from(side) + 1;
            let start = start % mask_height;
            let looks = [Mesh::of_single_rows, Mesh::of_sub_blocks, Mesh::of_windows];
            for mesh in looks.into_iter().filter_map(|of| of(WindowPx::square(side))) {
                let rows = 0..mesh.cell_rows(height);
                let rows: Vec<_> = rows.filter(|&row| mesh.mask_rows(row, mask_height).contains(&start)).collect();
                prop_assert_eq!(rows.len(), 1);
                let between = mesh.look != Look::Rows && side % 2 == 0 && start % 2 == 1;
                let starts = if between { vec![start - 1, start + 1] } else { vec![start] };
                for start in starts {
                    let covered = |band: &u32| {
                        let mut rows = mesh.pixel_rows(*band);
                        rows.end <= height && rows.all(|row| DoubledGrid::samples_on(row, start, side) == 2)
                    };
                    let mut seen = mesh.bands_seen(rows[0]).filter(|&band| band < mesh.bands(height));
                    prop_assert!(seen.any(|band| covered(&band)));
                }
            }
        }

        /// Wherever a window starts, one of the lattice's sub-blocks lies under it in full.
        #[test]
        fn every_window_covers_a_sub_block_of_the_lattice(side in 3u16..60, start in 0u32..200, before in 0u32..9) {
            let lattice = Lattice::of(WindowPx::square(side)).unwrap();
            let pixel = DoubledGrid::pixels_of_starts(&(start..start + 1)).start;
            let columns = lattice.columns(&(pixel.saturating_sub(before)..pixel + 1));
            let covered = |first: u32| {
                (first..first + lattice.sub_block.width_px).all(|at| DoubledGrid::samples_on(at, start, side) == 2)
            };
            prop_assert!(columns.end <= pixel + 1 + lattice.reach_px());
            prop_assert!(columns.step_by(lattice.column_step as usize).any(covered));
        }

        /// Halves of a window's sub-block differ by no more than what its own spread allows.
        #[test]
        fn halves_differ_by_no_more_than_the_spread_allows(
            levels in prop::collection::vec(any::<u8>(), 36), flat in 0usize..36, level: u8,
        ) {
            let mut levels: Vec<u64> = levels.into_iter().map(u64::from).collect();
            levels[flat..].fill(u64::from(level));
            let (sum, squares): (u64, u64) = levels.iter().fold((0, 0), |(s, q), x| (s + 4 * x, q + 4 * x * x));
            let spread = 144 * squares - sum * sum;
            let bounds = Bounds { low: 0, high: spread };
            let accepted = Acceptance { sum: [Bounds { low: 0, high: 255 * 144 }; 3], spread: [bounds; 3] };
            let most = SubBlock { width_px: 4, height_px: 4 }.most_between_halves(&accepted, 144);
            let half = |first: usize| -> u64 { (first..first + 2).flat_map(|row| &levels[6 * row..6 * row + 4]).sum() };
            prop_assert!(half(0).abs_diff(half(2)) < 8 * (u64::from(most) + 1));
        }
    }
}
