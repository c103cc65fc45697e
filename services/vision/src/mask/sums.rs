//! The smallest and largest sum S of the windows in every cell: a [survey](super::survey) by whole windows.
//!
//! It takes about twice as long as one by sub-blocks and needs no wider bounds, which pays where many landmarks share it:
//! some of them always come near the background. Only windows that start on the first samples of pixels are summed; the
//! others are means of those ([`super::mesh`]). Channels stay interleaved, as they lie in the frame.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::exact::BLOCK_PX;
use super::mesh::{Mesh, SubBlock};
use super::ranges::Ranges;
use super::sieve::{STEP_BYTES, join_shifted, row_bytes};

/// Blocks summed side by side: their sums stay in the first-level cache.
const MOST_BLOCKS: usize = 24;

/// Pixels of the largest windows: their sums fit into 16 bits.
const MOST_PIXELS: u32 = 257;

/// Memory of the sums.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    /// Of the rows under the windows, for each byte of a row, and of 2, 4, 8 … pixels of them from there on.
    levels: Vec<Vec<u16>>,
    lowest: Vec<u16>,
    highest: Vec<u16>,
    memory: Vec<u16>,
    /// Memory to join the extremes.
    joined: [Vec<u16>; 2],
    /// Width and height of a window in pixels.
    wide: usize,
    high: usize,
}

/// Whether the sums of such windows fit.
pub(super) fn fit(mesh: Mesh) -> bool {
    let SubBlock { width_px, height_px } = mesh.sub_block();
    width_px * height_px <= MOST_PIXELS
}

impl Sums {
    /// Notes the extremes over all cells of the grid's region.
    #[inline(always)]
    pub(super) fn take(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, ranges: &mut Ranges) {
        let SubBlock { width_px, height_px } = mesh.sub_block();
        (self.wide, self.high) = (width_px as usize, height_px as usize);
        let blocks = ranges.blocks();
        let strip = blocks.div_ceil(blocks.div_ceil(MOST_BLOCKS));
        for first in (0..blocks).step_by(strip) {
            self.take_strip(frame, grid, mesh, first..blocks.min(first + strip), ranges);
        }
    }

    #[inline(always)]
    fn take_strip(
        &mut self,
        frame: &Frame,
        grid: &DoubledGrid,
        mesh: Mesh,
        blocks: Range<usize>,
        ranges: &mut Ranges,
    ) {
        let region = grid.region();
        self.prepare(blocks.len() + (self.wide + 1).div_ceil(BLOCK_PX as usize));
        let first_px = BLOCK_PX * blocks.start as u32;
        let end_px = (BLOCK_PX * blocks.end as u32 + self.wide as u32).min(region.width);
        let bytes = 3 * (region.x + first_px) as usize..3 * (region.x + end_px) as usize;
        let row = |row: u32| &frame.row(region.y + row)[bytes.clone()];
        let (bands, pixels) = (mesh.bands(region.height), (self.wide * self.high) as u16);
        // In the last block perhaps no window begins: then it does not matter what is noted.
        let valid = 3 * ((end_px - first_px + 1) as usize).saturating_sub(self.wide).max(1);
        for cell_row in 0..ranges.rows() {
            let seen = mesh.bands_seen(cell_row as u32);
            for band in seen.start..seen.end.min(bands) {
                let last = band + self.high as u32 - 1;
                if band == 0 {
                    (0..=last).for_each(|ahead| self.enter(row(ahead)));
                } else if band > seen.start {
                    self.descend(row(last), row(band - 1));
                }
                if band == seen.start {
                    self.widen(|low, high, sum| (*low, *high) = (sum, sum));
                } else {
                    self.widen(|low, high, sum| (*low, *high) = (sum.min(*low), sum.max(*high)));
                }
            }
            let (extremes, levels) = ([&mut self.lowest[..], &mut self.highest[..]], levels(pixels));
            ranges.note(cell_row, blocks.clone(), valid, extremes, &mut self.joined, levels);
        }
    }

    #[inline(always)]
    fn prepare(&mut self, blocks: usize) {
        let length = row_bytes(blocks);
        let levels = 1 + self.wide.ilog2() as usize;
        self.levels.resize_with(levels.max(self.levels.len()), Vec::new);
        for level in &mut self.levels {
            level.clear();
            level.resize(length + (3 * self.wide).next_multiple_of(STEP_BYTES), 0);
        }
        for buffer in [&mut self.lowest, &mut self.highest] {
            buffer.resize(length, 0);
        }
    }

    #[inline(always)]
    fn enter(&mut self, row: &[u8]) {
        for (sum, &enter) in self.levels[0].iter_mut().zip(row) {
            *sum = sum.wrapping_add(u16::from(enter));
        }
    }

    #[inline(always)]
    fn descend(&mut self, entering: &[u8], leaving: &[u8]) {
        for ((sum, &enter), &leave) in self.levels[0].iter_mut().zip(entering).zip(leaving) {
            *sum = sum.wrapping_add(u16::from(enter)).wrapping_sub(u16::from(leave));
        }
    }

    /// Sums over the pixels under each window of the present rows, and changes the extremes by them.
    #[inline(always)]
    fn widen(&mut self, change: impl Fn(&mut u16, &mut u16, u16)) {
        let Self { levels, lowest, highest, memory, wide, .. } = self;
        let top = wide.ilog2() as usize;
        for level in 1..=top {
            let (below, this) = levels.split_at_mut(level);
            join_shifted(&below[level - 1], 3 << (level - 1), &mut this[0], u16::wrapping_add);
        }
        // The window's width in powers of two, the largest first.
        let (mut ahead, last) = (1 << top, wide.trailing_zeros() as usize);
        let extremes = lowest.iter_mut().zip(highest);
        if last == top {
            return extremes.zip(&levels[top]).for_each(|((low, high), &sum)| change(low, high, sum));
        }
        let mut sums = &levels[top];
        for level in (last + 1..top).rev().filter(|level| *wide & 1 << level != 0) {
            if ahead == 1 << top {
                memory.clear();
                memory.extend_from_slice(&levels[top][..levels[0].len()]);
            }
            for (sum, &more) in memory.iter_mut().zip(&levels[level][3 * ahead..]) {
                *sum = sum.wrapping_add(more);
            }
            ahead += 1 << level;
        }
        if ahead > 1 << top {
            sums = memory;
        }
        for (((low, high), &sum), &more) in extremes.zip(sums).zip(&levels[last][3 * ahead..]) {
            change(low, high, sum.wrapping_add(more));
        }
    }
}

/// The whole levels below and above the mean of so many pixels' sum. A multiplication does for the division: it is exact,
/// since sums and pixels below 2¹⁷ and 2⁹ leave an error below 2²⁶ of 2³².
#[inline(always)]
fn levels(pixels: u16) -> (impl Fn(u16) -> u8, impl Fn(u16) -> u8) {
    let inverse = (1_u64 << 32).div_ceil(u64::from(pixels));
    let quotient = move |sum: u64| ((sum * inverse) >> 32) as u8;
    let above = move |sum: u16| quotient(u64::from(sum) + u64::from(pixels) - 1);
    (move |sum: u16| quotient(u64::from(sum)), above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn levels_enclose_the_mean(pixels in 1..=MOST_PIXELS as u16, sum: u16) {
            let sum = (u32::from(sum) % (255 * u32::from(pixels) + 1)) as u16;
            let (below, above) = levels(pixels);
            prop_assert_eq!((below(sum), above(sum)), ((sum / pixels) as u8, sum.div_ceil(pixels) as u8));
        }
    }
}
