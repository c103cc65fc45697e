//! The range of levels in every cell of a region, and what it says of a landmark.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::statistics::Bounds;

use super::aligned::Aligned;
use super::cells::Cells;
use super::chunk::fit;
use super::exact::BLOCK_PX;
use super::mesh::Mesh;
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
    /// Prepares for the cells of the grid's region.
    pub(super) fn fit_to(&mut self, grid: &DoubledGrid, mesh: Mesh) {
        let region = grid.region();
        (self.rows, self.blocks) =
            (mesh.cell_rows(region.height) as usize, region.width.div_ceil(BLOCK_PX) as usize);
        for cells in self.low.iter_mut().chain(&mut self.high) {
            fit(cells, self.rows * self.blocks);
        }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn blocks(&self) -> usize {
        self.blocks
    }

    /// Notes a row of cells: the extremes over each block's pixels and the first one after them. (Windows that start on the
    /// second sample of the block's last pixel cover the next one first.) `lowest` and `highest` are extremes over the cells'
    /// rows from each pixel on, and hold what means something before number `valid`.
    #[inline(always)]
    pub(super) fn note(
        &mut self,
        row: usize,
        valid: usize,
        [lowest, highest]: [&mut [u8]; 2],
        memory: &mut [Aligned<u8>; 2],
    ) {
        let cells = row * self.blocks..(row + 1) * self.blocks;
        for extremes in [&mut *lowest, &mut *highest] {
            repeat_last_pixel(&mut extremes[..BLOCK_BYTES * cells.len() + 3], valid);
        }
        note_extremes(&mut self.low, cells.clone(), lowest, memory, u8::min);
        note_extremes(&mut self.high, cells, highest, memory, u8::max);
    }

    /// The lowest and the highest levels of a channel in these cells.
    #[inline(always)]
    pub(super) fn channel(&self, channel: usize, cells: Range<usize>) -> [&[u8]; 2] {
        [&self.low[channel][cells.clone()], &self.high[channel][cells]]
    }

    /// As [`channel`](Self::channel), to be set.
    #[inline(always)]
    pub(super) fn channel_mut(&mut self, channel: usize, cells: Range<usize>) -> [&mut [u8]; 2] {
        [&mut self.low[channel][cells.clone()], &mut self.high[channel][cells]]
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

/// Notes what `with` makes of every block and the pixel after it.
#[inline(always)]
fn note_extremes(
    levels: &mut [Vec<u8>; 3],
    cells: Range<usize>,
    row: &[u8],
    memory: &mut [Aligned<u8>; 2],
    with: impl Fn(u8, u8) -> u8,
) {
    join_blocks(row, cells.len(), memory, &with);
    let [red, green, blue] = levels.each_mut().map(|levels| levels[cells.clone()].iter_mut());
    let blocks = memory[0].as_chunks::<QUARTER>().0.iter().zip(row[BLOCK_BYTES..].chunks(BLOCK_BYTES));
    for (((red, green), blue), (block, next)) in red.zip(green).zip(blue).zip(blocks) {
        let [first, second, third, ..] = next else { return };
        *red = with(block[0], *first);
        *green = with(block[1], *second);
        *blue = with(block[2], *third);
    }
}

/// Makes `memory[0]` what `with` makes of each channel in every block: in the first three of [`QUARTER`] numbers.
#[inline(always)]
fn join_blocks(
    row: &[u8],
    blocks: usize,
    [joined, memory]: &mut [Aligned<u8>; 2],
    with: impl Fn(u8, u8) -> u8,
) {
    for buffer in [&mut *joined, &mut *memory] {
        buffer.fit((QUARTER * blocks).next_multiple_of(STEP_BYTES) + STEP_BYTES);
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
fn join_quarters(block: &[u8; BLOCK_BYTES], with: impl Fn(u8, u8) -> u8) -> [u8; QUARTER] {
    let (mut halves, mut quarter) = ([0; 2 * QUARTER], [0; QUARTER]);
    for at in 0..2 * QUARTER {
        halves[at] = with(block[at], block[at + 2 * QUARTER]);
    }
    for at in 0..QUARTER {
        quarter[at] = with(halves[at], halves[at + QUARTER]);
    }
    quarter
}
