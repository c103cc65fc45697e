//! Proof, for most of the frame, that no window of one landmark there can match, from one row of pixels in several.
//!
//! The sub-blocks ([`super::mesh`]) are short runs of pixels in single rows, so most of the frame is never read.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::statistics::Bounds;

use super::aligned::Aligned;
use super::cells::Cells;
use super::exact::BLOCK_PX;
use super::lanes::Work;
use super::mesh::Mesh;

/// Bytes of a block's pixels.
pub(super) const BLOCK_BYTES: usize = 3 * BLOCK_PX as usize;

/// Byte averages of a sub-block that may belong to a matching window, repeated for the pixels of a block.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    low: [u8; BLOCK_BYTES],
    reach: [u8; BLOCK_BYTES],
}

impl Levels {
    pub(super) fn new(averages: [Bounds<u8>; 3]) -> Self {
        let mut levels = Self { low: [0; BLOCK_BYTES], reach: [0; BLOCK_BYTES] };
        for (channel, Bounds { low, high }) in averages.into_iter().enumerate() {
            for at in (channel..BLOCK_BYTES).step_by(3) {
                (levels.low[at], levels.reach[at]) = (low, high - low);
            }
        }
        levels
    }
}

/// 1 for the bytes that begin a pixel.
const PIXEL_STARTS: [u8; BLOCK_BYTES] = {
    let mut starts = [0; BLOCK_BYTES];
    let mut at = 0;
    while at < BLOCK_BYTES {
        starts[at] = 1;
        at += 3;
    }
    starts
};

/// Memory of the sieve.
#[derive(Clone, Debug, Default)]
pub(super) struct Sieve {
    averages: Aligned<u8>,
    next_averages: Aligned<u8>,
    inside: Aligned<u8>,
}

/// A look at one row of each band: sets the cells where a window may match one of the shades.
pub(super) struct Sift<'a> {
    pub(super) sieve: &'a mut Sieve,
    pub(super) frame: &'a Frame,
    pub(super) grid: &'a DoubledGrid,
    pub(super) mesh: Mesh,
    pub(super) levels: &'a [Levels],
    pub(super) cells: &'a mut Cells,
}

impl Work for Sift<'_> {
    #[inline(always)]
    fn run(self) {
        self.sieve.sift(self.frame, self.grid, self.mesh, self.levels, self.cells);
    }
}

impl Sieve {
    #[inline(always)]
    fn sift(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, levels: &[Levels], cells: &mut Cells) {
        let region = grid.region();
        let bands = mesh.bands(region.height);
        let blocks = region.width.div_ceil(BLOCK_PX) as usize;
        for buffer in [&mut self.averages, &mut self.next_averages, &mut self.inside] {
            buffer.fit(row_bytes(blocks));
        }
        cells.reset(bands as usize, blocks);
        for band in 0..bands {
            let start = 3 * region.x as usize;
            let row = frame.row(region.y + mesh.pixel_rows(band).start);
            self.average(&row[start..start + 3 * region.width as usize], mesh.sub_block().width_px.ilog2());
            for levels in levels {
                let inside: &mut [u8] = &mut self.inside;
                compare(&self.averages, levels, inside);
                for (block, alive) in cells.band(band as usize).iter_mut().enumerate() {
                    *alive |= any_pixel(&inside[BLOCK_BYTES * block..][..BLOCK_BYTES + 3]);
                }
            }
        }
    }

    /// The averages of the sub-blocks from each byte on. Those beyond the row mean nothing; no window of the region begins
    /// there.
    #[inline(always)]
    fn average(&mut self, row: &[u8], halvings: u32) {
        self.averages[..row.len()].copy_from_slice(row);
        average_runs(&mut self.averages, &mut self.next_averages, halvings);
    }
}

/// Bytes that are worked on together: whole vectors of every instruction set.
pub(super) const STEP_BYTES: usize = 64;

/// Memory for the bytes of a row of `blocks` blocks, the pixel after them, and what [`join_shifted`] reads beyond.
#[inline(always)]
pub(super) fn row_bytes(blocks: usize) -> usize {
    (BLOCK_BYTES * blocks + 3).next_multiple_of(STEP_BYTES) + STEP_BYTES
}

/// Makes of each byte the rounded average of the 2^`halvings` pixels from there on.
#[inline(always)]
pub(super) fn average_runs(averages: &mut Aligned<u8>, memory: &mut Aligned<u8>, halvings: u32) {
    for halving in 0..halvings {
        join_shifted(averages, 3 << halving, memory, average);
        std::mem::swap(averages, memory);
    }
}

/// `with` of every number and the one `shift` after it, but for those that [`row_bytes`] adds at the end.
#[inline(always)]
pub(super) fn join_shifted<T: Copy>(row: &[T], shift: usize, joined: &mut [T], with: impl Fn(T, T) -> T) {
    // A length of whole steps: the loop never comes to its remainder.
    let count = row.len() - STEP_BYTES;
    for ((joined, &left), &right) in
        joined[..count].iter_mut().zip(&row[..count]).zip(&row[shift..shift + count])
    {
        *joined = with(left, right);
    }
}

/// Half the sum, rounded up: one instruction on vectors of bytes.
#[inline(always)]
pub(super) fn average(left: u8, right: u8) -> u8 {
    ((u16::from(left) + u16::from(right) + 1) >> 1) as u8
}

/// 1 for every byte average within the bounds.
#[inline(always)]
fn compare(averages: &[u8], levels: &Levels, inside: &mut [u8]) {
    let blocks = averages.as_chunks::<BLOCK_BYTES>().0.iter().zip(inside.as_chunks_mut::<BLOCK_BYTES>().0);
    for (averages, inside) in blocks {
        for at in 0..BLOCK_BYTES {
            inside[at] = u8::from(averages[at].wrapping_sub(levels.low[at]) <= levels.reach[at]);
        }
    }
}

/// 1 where some pixel of a block, or the first one after it, is inside in all three channels; else 0. (Windows that start
/// on the second sample of the block's last pixel cover the next one first.)
#[inline(always)]
fn any_pixel(inside: &[u8]) -> u8 {
    let mut any = 0;
    for at in 0..BLOCK_BYTES {
        any |= inside[at] & inside[at + 1] & inside[at + 2] & PIXEL_STARTS[at];
    }
    any | inside[BLOCK_BYTES] & inside[BLOCK_BYTES + 1] & inside[BLOCK_BYTES + 2]
}
