//! One row of pixels, split into its three channels.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::chunk::{WIDTH, fit};

/// Levels of R, G and B of a stretch of one row of the region.
#[derive(Clone, Debug, Default)]
pub(super) struct Planes {
    channels: [Vec<u8>; 3],
    first_column: u32,
    columns: usize,
    row: Option<u32>,
}

impl Planes {
    /// Prepares for `columns` columns, in whole chunks, from column `first` of the region on.
    #[inline(always)]
    pub(super) fn fit(&mut self, first: u32, columns: usize) {
        (self.first_column, self.columns, self.row) = (first, columns, None);
        for channel in &mut self.channels {
            fit(channel, columns);
        }
    }

    /// Reads row `row` of the region, if it is not the one read last. Columns beyond the region are black; no window that
    /// counts sees them.
    #[inline(always)]
    pub(super) fn read(&mut self, frame: &Frame, grid: &DoubledGrid, row: u32) {
        if self.row.replace(row) == Some(row) {
            return;
        }
        let region = grid.region();
        let inside = ((region.width - self.first_column) as usize).min(self.columns);
        let start = 3 * (region.x + self.first_column) as usize;
        let pixels = &frame.row(region.y + row)[start..start + 3 * inside];
        let (whole, rest) = pixels.as_chunks::<{ 3 * WIDTH }>();
        let mut x = 0;
        for pixels in whole {
            self.split(x, pixels);
            x += WIDTH;
        }
        if x < self.columns {
            let mut last = [0; 3 * WIDTH];
            last[..rest.len()].copy_from_slice(rest);
            self.split(x, &last);
            x += WIDTH;
        }
        for channel in &mut self.channels {
            channel[x.min(self.columns)..self.columns].fill(0);
        }
    }

    /// The row read last, R, G, B.
    #[inline(always)]
    pub(super) fn channels(&self) -> [&[u8]; 3] {
        self.channels.each_ref().map(|channel| &channel[..self.columns])
    }

    #[inline(always)]
    fn split(&mut self, x: usize, pixels: &[u8; 3 * WIDTH]) {
        for (channel, levels) in self.channels.iter_mut().enumerate() {
            let levels = &mut levels[x..x + WIDTH];
            for at in 0..WIDTH {
                levels[at] = pixels[3 * at + channel];
            }
        }
    }
}
