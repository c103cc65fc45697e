//! The darkest and lightest sub-blocks of every cell: a [survey](super::survey) by byte averages.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::aligned::Aligned;
use super::mesh::{Mesh, SubBlock};
use super::ranges::Ranges;
use super::sieve::{average, average_runs, row_bytes};

/// Memory of the averages.
#[derive(Clone, Debug, Default)]
pub(super) struct SubBlocks {
    /// Those of the present band.
    averages: Aligned<u8>,
    memory: Aligned<u8>,
    /// Their extremes over the bands of the present row of cells.
    lowest: Aligned<u8>,
    highest: Aligned<u8>,
    /// Memory to join them.
    joined: [Aligned<u8>; 2],
}

impl SubBlocks {
    /// Notes the extremes over all cells of the grid's region.
    #[inline(always)]
    pub(super) fn take(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, ranges: &mut Ranges) {
        for buffer in [&mut self.averages, &mut self.memory, &mut self.lowest, &mut self.highest] {
            buffer.fit(row_bytes(ranges.blocks()));
        }
        // Sub-blocks that stick out of the region mean nothing; no window of the region begins there.
        let valid = 3 * (grid.region().width + 1 - mesh.sub_block().width_px) as usize;
        let bands = mesh.bands(grid.region().height);
        for row in 0..ranges.rows() {
            let seen = mesh.bands_seen(row as u32);
            for band in seen.start..seen.end.min(bands) {
                // The last band of the row of cells above is the first one of this.
                if band > seen.start || row == 0 {
                    self.average(frame, grid, mesh, band);
                }
                if band == seen.start {
                    self.lowest.copy_from_slice(&self.averages);
                    self.highest.copy_from_slice(&self.averages);
                } else {
                    self.widen();
                }
            }
            ranges.note(row, valid, [&mut self.lowest, &mut self.highest], &mut self.joined);
        }
    }

    /// The rounded averages of the sub-blocks of one band, from each pixel on.
    #[inline(always)]
    fn average(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, band: u32) {
        let region = grid.region();
        let bytes = 3 * region.x as usize..3 * (region.x + region.width) as usize;
        let first = region.y + mesh.pixel_rows(band).start;
        let row = |ahead: u32| &frame.row(first + ahead)[bytes.clone()];
        let SubBlock { width_px, height_px } = mesh.sub_block();
        average_rows(row, height_px, &mut self.averages);
        average_runs(&mut self.averages, &mut self.memory, width_px.ilog2());
    }

    /// Extends the extremes to the present band.
    #[inline(always)]
    fn widen(&mut self) {
        for ((low, high), &average) in
            self.lowest.iter_mut().zip(self.highest.iter_mut()).zip(self.averages.iter())
        {
            *low = average.min(*low);
            *high = average.max(*high);
        }
    }
}

/// The rounded averages, byte by byte, of so many rows: 1, 2, 4 or 8.
#[inline(always)]
pub(super) fn average_rows<'a>(row: impl Fn(u32) -> &'a [u8] + Copy, rows: u32, averages: &mut [u8]) {
    match rows {
        1 => averages[..row(0).len()].copy_from_slice(row(0)),
        2 => average_two([row(0), row(1)], averages),
        4 => average_four([0, 1, 2, 3].map(row), averages),
        _ => average_eight([0, 1, 2, 3, 4, 5, 6, 7].map(row), averages),
    }
}

#[inline(always)]
fn average_two([first, second]: [&[u8]; 2], averages: &mut [u8]) {
    for ((target, &first), &second) in averages.iter_mut().zip(first).zip(second) {
        *target = average(first, second);
    }
}

#[inline(always)]
fn average_four(rows: [&[u8]; 4], averages: &mut [u8]) {
    let [a, b, c, d] = rows;
    for ((((target, &a), &b), &c), &d) in averages.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *target = average(average(a, b), average(c, d));
    }
}

#[inline(always)]
fn average_eight(rows: [&[u8]; 8], averages: &mut [u8]) {
    let [a, b, c, d, e, f, g, h] = rows;
    let upper = a.iter().zip(b).zip(c.iter().zip(d));
    let lower = e.iter().zip(f).zip(g.iter().zip(h));
    for ((target, ((a, b), (c, d))), ((e, f), (g, h))) in averages.iter_mut().zip(upper).zip(lower) {
        let upper = average(average(*a, *b), average(*c, *d));
        *target = average(upper, average(average(*e, *f), average(*g, *h)));
    }
}
