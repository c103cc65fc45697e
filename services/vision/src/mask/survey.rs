//! The darkest and lightest sub-blocks of every cell of a region: one pass over the frame for all landmarks of one
//! window.
//!
//! A landmark whose bounds ([`super::mesh`]) miss a cell's range in any channel has no matching window there. The pass
//! reads every pixel once or twice; asking it about a landmark then costs a few bytes a cell.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::statistics::Bounds;

use super::cells::Cells;
use super::chunk::fit;
use super::exact::BLOCK_PX;
use super::lanes::Work;
use super::mesh::Mesh;
use super::sieve::{BLOCK_BYTES, average, average_runs};

/// What was seen, and the memory to see it with.
#[derive(Clone, Debug, Default)]
pub(super) struct Survey {
    grid: Option<DoubledGrid>,
    /// For each channel and cell the smallest average.
    low: [Vec<u8>; 3],
    /// And the largest.
    high: [Vec<u8>; 3],
    bands: usize,
    blocks: usize,
    rows: [Vec<u8>; 8],
    memory: Vec<u8>,
    /// 1 for the cells whose ranges touch one shade's bounds in all channels.
    touching: Vec<u8>,
}

/// A pass over the grid's region for a survey.
pub(super) struct Take<'a> {
    pub(super) survey: &'a mut Survey,
    pub(super) frame: &'a Frame,
    pub(super) grid: &'a DoubledGrid,
    pub(super) mesh: Mesh,
}

impl Work for Take<'_> {
    #[inline(always)]
    fn run(self) {
        self.survey.take(self.frame, self.grid, self.mesh);
    }
}

/// A question to a survey: sets the cells where a window may match one of the shades.
pub(super) struct Ask<'a> {
    pub(super) survey: &'a mut Survey,
    pub(super) shades: &'a [[Bounds<u8>; 3]],
    pub(super) cells: &'a mut Cells,
}

impl Work for Ask<'_> {
    #[inline(always)]
    fn run(self) {
        self.survey.ask(self.shades, self.cells);
    }
}

impl Survey {
    /// What was surveyed last, and not forgotten.
    pub(super) fn grid(&self) -> Option<&DoubledGrid> {
        self.grid.as_ref()
    }

    /// Forgets what was seen.
    pub(super) fn forget(&mut self) {
        self.grid = None;
    }

    #[inline(always)]
    fn take(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh) {
        let region = grid.region();
        (self.bands, self.blocks) =
            (mesh.bands(region.height) as usize, region.width.div_ceil(BLOCK_PX) as usize);
        let padded = BLOCK_BYTES * (self.blocks + 1);
        for buffer in self.rows.iter_mut().chain([&mut self.memory]) {
            fit(buffer, padded);
        }
        for cells in self.low.iter_mut().chain(&mut self.high) {
            fit(cells, self.bands * self.blocks);
        }
        // Sub-blocks that stick out of the region mean nothing; no window of the region begins there.
        let valid = 3 * (region.width as usize + 1).saturating_sub(1 << mesh.run_halvings);
        for band in 0..self.bands {
            self.average_rows(frame, grid, mesh, band as u32);
            average_runs(&mut self.rows[0], &mut self.memory, mesh.run_halvings);
            for at in valid..BLOCK_BYTES * self.blocks + 3 {
                self.rows[0][at] = self.rows[0][at - 3];
            }
            self.note_extremes(band);
        }
        self.grid = Some(*grid);
    }

    #[inline(always)]
    fn ask(&mut self, shades: &[[Bounds<u8>; 3]], cells: &mut Cells) {
        cells.reset(self.bands, self.blocks);
        for shade in shades {
            self.touching.clear();
            self.touching.resize(self.bands * self.blocks, 1);
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

    /// The rounded averages over the rows of one band, in the first of `rows`.
    #[inline(always)]
    fn average_rows(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, band: u32) {
        let region = grid.region();
        let bytes = 3 * region.x as usize..3 * (region.x + region.width) as usize;
        let first = region.y + mesh.pixel_rows(band).start;
        let row = |ahead: u32| &frame.row(first + ahead)[bytes.clone()];
        let mut count = 1_usize << mesh.row_halvings;
        if count == 1 {
            self.rows[0][..bytes.len()].copy_from_slice(row(0));
            return;
        }
        count /= 2;
        for (ahead, target) in (0..).step_by(2).zip(&mut self.rows[..count]) {
            let (upper, lower) = (row(ahead), row(ahead + 1));
            for ((target, &upper), &lower) in target.iter_mut().zip(upper).zip(lower) {
                *target = average(upper, lower);
            }
        }
        while count > 1 {
            for pair in 0..count / 2 {
                let (upper, lower) = self.rows.split_at_mut(2 * pair + 1);
                let (upper, lower) = (&mut upper[2 * pair][..bytes.len()], &lower[0][..bytes.len()]);
                for (upper, &lower) in upper.iter_mut().zip(lower) {
                    *upper = average(*upper, lower);
                }
                self.rows.swap(pair, 2 * pair);
            }
            count /= 2;
        }
    }

    /// The extremes of the averages of each block's pixels and the first one after them. (Windows that start on the
    /// second sample of the block's last pixel cover the next one first.)
    #[inline(always)]
    fn note_extremes(&mut self, band: usize) {
        let (blocks, after) = (self.rows[0].as_chunks::<BLOCK_BYTES>().0, &self.rows[0][BLOCK_BYTES..]);
        for (block, pixels) in blocks.iter().enumerate().take(self.blocks) {
            let mut low = [u8::MAX; FOLD_BYTES];
            let mut high = [0; FOLD_BYTES];
            for part in pixels.as_chunks::<FOLD_BYTES>().0 {
                for at in 0..FOLD_BYTES {
                    low[at] = low[at].min(part[at]);
                    high[at] = high[at].max(part[at]);
                }
            }
            let next = &after[BLOCK_BYTES * block..][..3];
            for (channel, &next) in next.iter().enumerate() {
                let (mut least, mut most) = (next, next);
                for at in (channel..FOLD_BYTES).step_by(3) {
                    (least, most) = (least.min(low[at]), most.max(high[at]));
                }
                self.low[channel][band * self.blocks + block] = least;
                self.high[channel][band * self.blocks + block] = most;
            }
        }
    }
}

/// Bytes folded onto each other: whole vectors of every instruction set, and whole pixels.
const FOLD_BYTES: usize = 48;
