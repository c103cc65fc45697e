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
const CELL_ROWS: u32 = 8;

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
    /// Size of a sub-block.
    width_px: u32,
    height_px: u32,
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
        let width_px = 1 << width.ilog2().min(MOST_HALVINGS);
        Some(Self { look: Look::Rows, width_px, height_px: 1, row_step: height, together: 1 })
    }

    /// Sub-blocks of several rows, whose extremes over a cell are looked at: they see nearly every pixel, and prove more.
    pub(super) fn of_sub_blocks(window: WindowPx) -> Option<Self> {
        let (width, height) = aligned(window)?;
        let side = |pixels: u32| 1 << pixels.ilog2().min(MOST_HALVINGS);
        let (width_px, height_px) = (side(width), side(height));
        let row_step = height - height_px + 1;
        let together = CELL_ROWS.div_ceil(row_step);
        Some(Self { look: Look::SubBlocks, width_px, height_px, row_step, together })
    }

    /// Whole windows, whose extremes over a cell are looked at; `None` unless all windows are means of those that start
    /// on the first samples of pixels.
    pub(super) fn of_windows(window: WindowPx) -> Option<Self> {
        let even = window.width.is_multiple_of(2) && window.height.is_multiple_of(2);
        let (width_px, height_px) = aligned(window).filter(|_| even)?;
        Some(Self { look: Look::Windows, width_px, height_px, row_step: 1, together: CELL_ROWS })
    }

    /// Size of a sub-block.
    pub(super) fn size_px(self) -> (u32, u32) {
        (self.width_px, self.height_px)
    }

    /// How often rows and pixels are halved into averages, from whole ones to those of sub-blocks.
    pub(super) fn run_halvings(self) -> u32 {
        self.width_px.ilog2()
    }

    /// Whether it looks at whole windows.
    pub(super) fn is_of_windows(self) -> bool {
        self.look == Look::Windows
    }

    /// Samples of a sub-block, k: each of its pixels is four.
    fn samples(self) -> u32 {
        4 * self.width_px * self.height_px
    }

    /// The rows of pixels that band `band` looks at.
    pub(super) fn pixel_rows(self, band: u32) -> Range<u32> {
        let first = band * self.row_step;
        first..first + self.height_px
    }

    /// The rows of the mask that row `row` of cells decides on.
    pub(super) fn mask_rows(self, row: u32, mask_height: u32) -> Range<u32> {
        let bands = self.own_bands(row);
        let first = (bands.start * self.row_step + 1).saturating_sub(self.row_step);
        let pixels = first..(bands.end - 1) * self.row_step + 1;
        let rows = match self.look {
            Look::Rows => DoubledGrid::starts_with_first_whole_pixel(pixels),
            Look::SubBlocks | Look::Windows => {
                DoubledGrid::starts_on(pixels.start).start..DoubledGrid::starts_on(pixels.end).start
            }
        };
        rows.start.min(mask_height)..rows.end.min(mask_height)
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
        (region_height + 1).saturating_sub(self.height_px).div_ceil(self.row_step)
    }

    /// Byte averages of sub-blocks that may belong to a matching window, R, G, B; `None` where none can.
    pub(super) fn averages(self, accepted: &Acceptance, samples: u32) -> Option<[Bounds<u8>; 3]> {
        let (n, k) = (f64::from(samples), f64::from(self.samples()));
        let mut averages = [Bounds { low: 0, high: 0 }; 3];
        for (channel, averages) in averages.iter_mut().enumerate() {
            let largest_variance = accepted.spread[channel].high as f64 / (n * n);
            let wider = (largest_variance * (n - k).max(0.0) / k).sqrt() + ROUNDING;
            let averaging = match self.look {
                Look::Rows | Look::SubBlocks => {
                    f64::from(self.width_px.ilog2() + self.height_px.ilog2()) / 2.0
                }
                Look::Windows => 0.0,
            };
            let low = (f64::from(accepted.sum[channel].low) / n - wider).ceil().max(0.0);
            let high = (f64::from(accepted.sum[channel].high) / n + wider + averaging).floor().min(255.0);
            // Of extremes one may lie on either side of bounds that no level lies between.
            if low > high && self.look != Look::Windows {
                return None;
            }
            *averages = Bounds { low: low as u8, high: high as u8 };
        }
        Some(averages)
    }
}

/// Width and height in pixels of the windows that start on the first samples of pixels; `None` where one covers no pixel
/// in full.
fn aligned(window: WindowPx) -> Option<(u32, u32)> {
    let pixels = |side| Some(DoubledGrid::aligned_pixels(side)).filter(|&pixels| pixels > 0);
    Some((pixels(window.width)?, pixels(window.height)?))
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
    }
}
