//! The range of levels in every cell of a region, and what it says of a landmark.

use crate::statistics::Bounds;

use super::cells::Cells;
use super::chunk::fit;
use super::exact::BLOCK_PX;
use super::refute::{Doubt, Side};
use super::sieve::{BLOCK_BYTES, join_shifted};

/// The smallest and largest means that some sub-block of each cell has.
#[derive(Clone, Debug, Default)]
pub(super) struct Ranges {
    low: [Vec<u8>; 3],
    high: [Vec<u8>; 3],
    rows: usize,
    blocks: usize,
    /// 1 for the cells whose ranges touch one shade's bounds in all channels.
    touching: Vec<u8>,
}

impl Ranges {
    /// Prepares for so many cells.
    pub(super) fn fit(&mut self, rows: usize, blocks: usize) {
        (self.rows, self.blocks) = (rows, blocks);
        for cells in self.low.iter_mut().chain(&mut self.high) {
            fit(cells, rows * blocks);
        }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn blocks(&self) -> usize {
        self.blocks
    }

    /// Notes a row of cells: the extremes over each block's pixels and the first one after them. (Windows that start on the
    /// second sample of the block's last pixel cover the next one first.) `lowest` and `highest` are extremes over the
    /// cells' rows from each pixel on, and hold what means something before number `valid`; `floor` and `ceil` make levels
    /// of them.
    #[inline(always)]
    pub(super) fn note<T: Copy + Ord>(
        &mut self,
        row: usize,
        valid: usize,
        [lowest, highest, memory]: [&mut Vec<T>; 3],
        (floor, ceil): (impl Fn(T) -> u8, impl Fn(T) -> u8),
    ) {
        repeat_last_pixel(lowest, valid);
        repeat_last_pixel(highest, valid);
        spread(lowest, memory, T::min);
        spread(highest, memory, T::max);
        let cells = row * self.blocks..(row + 1) * self.blocks;
        for (channel, (low, high)) in self.low.iter_mut().zip(&mut self.high).enumerate() {
            let starts = (channel..).step_by(BLOCK_BYTES);
            for ((low, high), at) in low[cells.clone()].iter_mut().zip(&mut high[cells.clone()]).zip(starts) {
                *low = floor(lowest[at].min(lowest[at + 3]));
                *high = ceil(highest[at].max(highest[at + 3]));
            }
        }
    }

    /// Sets the cells where a window may match one of the shades.
    #[inline(always)]
    pub(super) fn ask(&mut self, shades: &[[Bounds<u8>; 3]], cells: &mut Cells) {
        cells.reset(self.rows, self.blocks);
        for shade in shades {
            self.touching.clear();
            self.touching.resize(self.rows * self.blocks, 1);
            for ((low, high), bounds) in self.low.iter().zip(&self.high).zip(shade) {
                for ((touching, &low), &high) in self.touching.iter_mut().zip(low).zip(high) {
                    *touching &= u8::from(low <= bounds.high) & u8::from(high >= bounds.low);
                }
            }
            for (flag, &touching) in cells.flags().iter_mut().zip(&self.touching) {
                *flag |= touching;
            }
        }
    }

    /// For every living cell whose middle level in some channel is not accepted, how it is furthest off, by number of the
    /// [`Doubt`]; else 0. Gives a set bit for each number that there is.
    pub(super) fn doubt(&self, means: &[Bounds<u8>; 3], cells: &Cells, doubts: &mut Vec<u8>) -> u8 {
        doubts.clear();
        doubts.resize(self.rows * self.blocks, 0);
        let mut numbers = 0;
        for row in 0..self.rows {
            let mut from = 0;
            while let Some(blocks) = cells.next_run(row, from) {
                from = blocks.end;
                let cells = row * self.blocks + blocks.start..row * self.blocks + blocks.end;
                for (cell, doubt) in cells.clone().zip(&mut doubts[cells]) {
                    *doubt = self.worst(means, cell);
                    numbers |= 1 << *doubt;
                }
            }
        }
        numbers
    }

    fn worst(&self, means: &[Bounds<u8>; 3], cell: usize) -> u8 {
        let (mut worst, mut furthest) = (0, 0);
        for (channel, means) in means.iter().enumerate() {
            let middle = self.low[channel][cell].midpoint(self.high[channel][cell]);
            let dark = (means.low.saturating_sub(middle), Doubt { channel, side: Side::TooDark });
            let light = (middle.saturating_sub(means.high), Doubt { channel, side: Side::TooLight });
            for (off, doubt) in [dark, light] {
                if off > furthest {
                    (worst, furthest) = (doubt.number(), off);
                }
            }
        }
        worst
    }
}

/// Continues a row with its last pixel, which ends before number `end`.
#[inline(always)]
fn repeat_last_pixel<T: Copy>(row: &mut [T], end: usize) {
    let (pixels, beyond) = row.split_at_mut(end);
    let last = &pixels[end - 3..];
    for pixel in beyond.chunks_exact_mut(3) {
        pixel.copy_from_slice(last);
    }
}

/// Makes of each number the extreme of those of its channel in the [`BLOCK_PX`] pixels from there on.
#[inline(always)]
fn spread<T: Copy>(extremes: &mut Vec<T>, memory: &mut Vec<T>, with: impl Fn(T, T) -> T) {
    for doubling in 0..BLOCK_PX.ilog2() {
        join_shifted(extremes, 3 << doubling, memory, &with);
        std::mem::swap(extremes, memory);
    }
}
