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
    pub(super) survey: &'a Survey,
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
    fn ask(&self, shades: &[[Bounds<u8>; 3]], cells: &mut Cells) {
        cells.reset(self.bands, self.blocks);
        let count = self.bands * self.blocks;
        let flags = &mut cells.flags()[..count];
        for [red, green, blue] in shades {
            let (low, high) = (
                self.low.each_ref().map(|low| &low[..count]),
                self.high.each_ref().map(|high| &high[..count]),
            );
            let touches = |channel: usize, at: usize, bounds: &Bounds<u8>| {
                u8::from(low[channel][at] <= bounds.high) & u8::from(high[channel][at] >= bounds.low)
            };
            for (at, flag) in flags.iter_mut().enumerate() {
                *flag |= touches(0, at, red) & touches(1, at, green) & touches(2, at, blue);
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
        for block in 0..self.blocks {
            let start = BLOCK_BYTES * block;
            let (pixels, after) = self.rows[0][start..start + BLOCK_BYTES + 3].split_at(BLOCK_BYTES);
            let low = folded(pixels, after, u8::min);
            let high = folded(pixels, after, u8::max);
            for channel in 0..3 {
                self.low[channel][band * self.blocks + block] = low[channel];
                self.high[channel][band * self.blocks + block] = high[channel];
            }
        }
    }
}

/// `with` of all pixels, R, G, B: halves onto halves, so that every step but the last runs on whole vectors.
#[inline(always)]
fn folded(pixels: &[u8], after: &[u8], with: impl Fn(u8, u8) -> u8 + Copy) -> [u8; 3] {
    let half: [u8; 48] = halved(pixels, with);
    let quarter: [u8; 24] = halved(&half, with);
    let eighth: [u8; 12] = halved(&quarter, with);
    let two: [u8; 6] = halved(&eighth, with);
    std::array::from_fn(|channel| with(with(two[channel], two[3 + channel]), after[channel]))
}

#[inline(always)]
fn halved<const N: usize>(bytes: &[u8], with: impl Fn(u8, u8) -> u8) -> [u8; N] {
    let (left, right) = bytes.split_at(N);
    let mut half = [0; N];
    for at in 0..N {
        half[at] = with(left[at], right[at]);
    }
    half
}
