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

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::landmark::WindowPx;
use crate::statistics::{Acceptance, Bounds};

/// Halvings that give the largest side of a sub-block: 2³ pixels.
const MOST_HALVINGS: u32 = 3;

/// The sub-blocks for one window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mesh {
    /// Sub-blocks are 2 to this power pixels wide,
    pub(super) run_halvings: u32,
    /// and high.
    pub(super) row_halvings: u32,
    row_step: u32,
}

impl Mesh {
    /// Sub-blocks of a single row, the cheapest to look at; `None` for windows so small that they may cover no pixel in
    /// full.
    pub(super) fn of_single_rows(window: WindowPx) -> Option<Self> {
        Self::new(window, 0)
    }

    /// Sub-blocks of several rows: they see every pixel, and prove more.
    pub(super) fn of_blocks(window: WindowPx) -> Option<Self> {
        Self::new(window, MOST_HALVINGS)
    }

    fn new(window: WindowPx, most_row_halvings: u32) -> Option<Self> {
        let run = DoubledGrid::whole_pixels(window.width);
        let rows = DoubledGrid::whole_pixels(window.height);
        (run > 0 && rows > 0).then(|| {
            let row_halvings = rows.ilog2().min(most_row_halvings);
            let row_step = rows - (1 << row_halvings) + 1;
            Self { run_halvings: run.ilog2().min(MOST_HALVINGS), row_halvings, row_step }
        })
    }

    /// Samples of a sub-block, k: each of its pixels is four.
    fn samples(self) -> u32 {
        4 << (self.run_halvings + self.row_halvings)
    }

    /// The rows of pixels that band `band` looks at.
    pub(super) fn pixel_rows(self, band: u32) -> Range<u32> {
        let first = band * self.row_step;
        first..first + (1 << self.row_halvings)
    }

    /// The rows of the mask that band `band` decides on.
    pub(super) fn mask_rows(self, band: u32, mask_height: u32) -> Range<u32> {
        let last = band * self.row_step;
        let first = (last + 1).saturating_sub(self.row_step);
        let rows = DoubledGrid::starts_with_first_whole_pixel(first..last + 1);
        rows.start.min(mask_height)..rows.end.min(mask_height)
    }

    /// Number of bands.
    pub(super) fn bands(self, region_height: u32) -> u32 {
        (region_height + 1).saturating_sub(1 << self.row_halvings).div_ceil(self.row_step)
    }

    /// Byte averages of sub-blocks that may belong to a matching window, R, G, B; `None` where none can.
    pub(super) fn averages(self, accepted: &Acceptance, samples: u32) -> Option<[Bounds<u8>; 3]> {
        let (n, k) = (f64::from(samples), f64::from(self.samples()));
        let mut averages = [Bounds { low: 0, high: 0 }; 3];
        for (channel, averages) in averages.iter_mut().enumerate() {
            let largest_variance = accepted.spread[channel].high as f64 / (n * n);
            let wider = (largest_variance * (n - k).max(0.0) / k).sqrt() + ROUNDING;
            let averaging = f64::from(self.run_halvings + self.row_halvings) / 2.0;
            let low = (f64::from(accepted.sum[channel].low) / n - wider).ceil().max(0.0);
            let high = (f64::from(accepted.sum[channel].high) / n + wider + averaging).floor().min(255.0);
            if low > high {
                return None;
            }
            *averages = Bounds { low: low as u8, high: high as u8 };
        }
        Some(averages)
    }
}

/// More than all rounding in the few operations above.
const ROUNDING: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every mask row belongs to a band whose rows of pixels its windows cover in full.
        #[test]
        fn every_window_covers_a_sub_block(side in 3u16..60, more in 0u32..70, start in 0u32..200) {
            let height = u32::from(side) + more;
            let mask_height = 2 * height - u32::from(side) + 1;
            let start = start % mask_height;
            for mesh in [Mesh::of_single_rows, Mesh::of_blocks].map(|of| of(WindowPx::square(side)).unwrap()) {
                let bands = (0..mesh.bands(height)).filter(|&band| mesh.mask_rows(band, mask_height).contains(&start));
                let bands: Vec<_> = bands.collect();
                prop_assert_eq!(bands.len(), 1);
                let rows = mesh.pixel_rows(bands[0]);
                prop_assert!(rows.end <= height);
                prop_assert!(rows.into_iter().all(|row| DoubledGrid::samples_on(row, start, side) == 2));
            }
        }
    }
}
