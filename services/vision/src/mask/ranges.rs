//! The range of levels in every cell of a region, and what it says of a landmark.

use std::ops::Range;

use crate::statistics::Bounds;

use super::cells::Cells;
use super::chunk::fit;
use super::refute::{Doubt, Side};
use super::sieve::{BLOCK_BYTES, STEP_BYTES, join_shifted};

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

    /// Notes a stretch of a row of cells: the extremes over each block's pixels and the first one after them. (Windows that
    /// start on the second sample of the block's last pixel cover the next one first.) `lowest` and `highest` are extremes
    /// over the cells' rows from each pixel on, and hold what means something before number `valid`; `levels` are made of the
    /// lowest and the highest.
    #[inline(always)]
    pub(super) fn note<T: Copy + Ord + Default>(
        &mut self,
        row: usize,
        blocks: Range<usize>,
        valid: usize,
        [lowest, highest]: [&mut [T]; 2],
        memory: &mut [Vec<T>; 2],
        levels: (impl Fn(T) -> u8, impl Fn(T) -> u8),
    ) {
        let cells = row * self.blocks + blocks.start..row * self.blocks + blocks.end;
        repeat_last_pixel(lowest, valid);
        join_blocks(lowest, blocks.len(), memory, T::min);
        note_blocks(&mut self.low, cells.clone(), &memory[0], lowest, |block, next| {
            levels.0(block.min(next))
        });
        repeat_last_pixel(highest, valid);
        join_blocks(highest, blocks.len(), memory, T::max);
        note_blocks(&mut self.high, cells, &memory[0], highest, |block, next| levels.1(block.max(next)));
    }

    /// The range of levels in every cell: R, G and B of its lowest, and of its highest.
    #[inline(always)]
    pub(super) fn cells(&self) -> impl Iterator<Item = ([u8; 3], [u8; 3])> {
        let cells = self.rows * self.blocks;
        let [low_red, low_green, low_blue] = &self.low;
        let [high_red, high_green, high_blue] = &self.high;
        let low = low_red[..cells].iter().zip(low_green).zip(low_blue);
        let high = high_red[..cells].iter().zip(high_green).zip(high_blue);
        let cells = low.zip(high);
        cells.map(|(((&r, &g), &b), ((&high_r, &high_g), &high_b))| ([r, g, b], [high_r, high_g, high_b]))
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

/// Numbers of a quarter of a block.
const QUARTER: usize = BLOCK_BYTES / 4;

/// Makes `memory[0]` what `with` makes of each channel in every block: in the first three of [`QUARTER`] numbers.
#[inline(always)]
fn join_blocks<T: Copy + Default>(
    row: &[T],
    blocks: usize,
    [joined, memory]: &mut [Vec<T>; 2],
    with: impl Fn(T, T) -> T,
) {
    for buffer in [&mut *joined, &mut *memory] {
        buffer.resize((QUARTER * blocks).next_multiple_of(STEP_BYTES) + STEP_BYTES, T::default());
    }
    for (quarter, block) in joined.as_chunks_mut::<QUARTER>().0.iter_mut().zip(&row.as_chunks().0[..blocks]) {
        *quarter = join_quarters(block, &with);
    }
    for shift in [QUARTER / 2, QUARTER / 4, QUARTER / 8] {
        join_shifted(joined, shift, memory, &with);
        std::mem::swap(joined, memory);
    }
}

#[inline(always)]
fn join_quarters<T: Copy + Default>(block: &[T; BLOCK_BYTES], with: impl Fn(T, T) -> T) -> [T; QUARTER] {
    let (mut halves, mut quarter) = ([T::default(); 2 * QUARTER], [T::default(); QUARTER]);
    for at in 0..2 * QUARTER {
        halves[at] = with(block[at], block[at + 2 * QUARTER]);
    }
    for at in 0..QUARTER {
        quarter[at] = with(halves[at], halves[at + QUARTER]);
    }
    quarter
}

/// Notes the level of every block, by what was made of it and the pixel after it in `row`.
#[inline(always)]
fn note_blocks<T: Copy>(
    levels: &mut [Vec<u8>; 3],
    cells: Range<usize>,
    joined: &[T],
    row: &[T],
    level: impl Fn(T, T) -> u8,
) {
    for (channel, levels) in levels.iter_mut().enumerate() {
        let blocks = joined[channel..].iter().step_by(QUARTER);
        let next = row[BLOCK_BYTES + channel..].iter().step_by(BLOCK_BYTES);
        for ((cell, &block), &next) in levels[cells.clone()].iter_mut().zip(blocks).zip(next) {
            *cell = level(block, next);
        }
    }
}
