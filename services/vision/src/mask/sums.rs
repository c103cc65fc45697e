//! The smallest and largest sum S of the windows in every cell: a [survey](super::survey) by whole windows.
//!
//! It takes about twice as long as one by sub-blocks and needs no wider bounds, which pays where many landmarks share it:
//! some of them always come near the background. Only windows that start on the first samples of pixels are summed; the
//! others are means of those ([`super::mesh`]). Channels stay interleaved, as they lie in the frame.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::mesh::Mesh;
use super::ranges::Ranges;
use super::sieve::{STEP_BYTES, join_shifted, row_bytes};

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
    /// Width and height of a window in pixels.
    wide: usize,
    high: usize,
}

/// Whether the sums of such windows fit.
pub(super) fn fit(mesh: Mesh) -> bool {
    let (wide, high) = mesh.size_px();
    wide * high <= MOST_PIXELS
}

impl Sums {
    /// Notes the extremes over all cells of the grid's region.
    #[inline(always)]
    pub(super) fn take(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, ranges: &mut Ranges) {
        let region = grid.region();
        self.prepare(mesh, ranges.blocks());
        let bytes = 3 * region.x as usize..3 * (region.x + region.width) as usize;
        let row = |row: u32| &frame.row(region.y + row)[bytes.clone()];
        let (bands, pixels) = (mesh.bands(region.height), (self.wide * self.high) as u16);
        let valid = 3 * (region.width as usize + 1 - self.wide);
        for cell_row in 0..ranges.rows() {
            self.lowest.fill(u16::MAX);
            self.highest.fill(0);
            let seen = mesh.bands_seen(cell_row as u32);
            for band in seen.start..seen.end.min(bands) {
                let last = band + self.high as u32 - 1;
                if band == 0 {
                    (0..=last).for_each(|ahead| self.enter(row(ahead)));
                } else if band > seen.start {
                    self.descend(row(last), row(band - 1));
                }
                self.widen();
            }
            self.memory.resize(self.lowest.len(), 0);
            let levels = (|sum: u16| (sum / pixels) as u8, |sum: u16| sum.div_ceil(pixels) as u8);
            ranges.note(cell_row, valid, [&mut self.lowest, &mut self.highest, &mut self.memory], levels);
        }
    }

    #[inline(always)]
    fn prepare(&mut self, mesh: Mesh, blocks: usize) {
        let (wide, high) = mesh.size_px();
        (self.wide, self.high) = (wide as usize, high as usize);
        let length = row_bytes(blocks);
        let levels = 1 + self.wide.ilog2() as usize;
        self.levels.resize_with(levels.max(self.levels.len()), Vec::new);
        for level in &mut self.levels {
            level.clear();
            level.resize(length + (3 * self.wide).next_multiple_of(STEP_BYTES), 0);
        }
        for buffer in [&mut self.lowest, &mut self.highest, &mut self.memory] {
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

    /// Sums over the pixels under each window of the present rows, and extends the extremes to them.
    #[inline(always)]
    fn widen(&mut self) {
        let top = self.wide.ilog2() as usize;
        for level in 1..=top {
            let (below, this) = self.levels.split_at_mut(level);
            join_shifted(&below[level - 1], 3 << (level - 1), &mut this[0], u16::wrapping_add);
        }
        // The window's width in powers of two, the largest first.
        let (mut ahead, last) = (1 << top, self.wide.trailing_zeros() as usize);
        if last == top {
            return extend(&mut self.lowest, &mut self.highest, self.levels[top].iter().copied());
        }
        self.memory.clear();
        self.memory.extend_from_slice(&self.levels[top][..self.lowest.len()]);
        for level in (last + 1..top).rev().filter(|level| self.wide & 1 << level != 0) {
            for (sum, &more) in self.memory.iter_mut().zip(&self.levels[level][3 * ahead..]) {
                *sum = sum.wrapping_add(more);
            }
            ahead += 1 << level;
        }
        let sums = self.memory.iter().zip(&self.levels[last][3 * ahead..]);
        extend(&mut self.lowest, &mut self.highest, sums.map(|(sum, more)| sum.wrapping_add(*more)));
    }
}

#[inline(always)]
fn extend(lowest: &mut [u16], highest: &mut [u16], sums: impl Iterator<Item = u16>) {
    for ((low, high), sum) in lowest.iter_mut().zip(highest).zip(sums) {
        *low = sum.min(*low);
        *high = sum.max(*high);
    }
}
