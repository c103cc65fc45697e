//! Rows of pixels, split into their three channels.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::chunk::fit;

/// Levels of R, G and B of a stretch of those rows of the region that lie under one window.
#[derive(Clone, Debug, Default)]
pub(super) struct Planes {
    /// Row after row, each as R, G, B; row r in place r modulo the number of places.
    levels: Vec<u8>,
    /// The row in each place.
    rows: Vec<Option<u32>>,
    first_column: u32,
    columns: usize,
}

impl Planes {
    /// Prepares for `columns` columns, in whole chunks, from column `first` of the region on, and for windows over
    /// `rows` rows of pixels, of which one more is needed while they move down.
    #[inline(always)]
    pub(super) fn fit(&mut self, first: u32, columns: usize, rows: usize) {
        (self.first_column, self.columns) = (first, columns);
        self.rows.clear();
        // A power of two: a row's place is found without a division.
        self.rows.resize((rows + 1).next_power_of_two(), None);
        fit(&mut self.levels, 3 * columns * self.rows.len());
    }

    /// Reads row `row` of the region, if it is not there yet. Columns beyond the region repeat the last one; no window
    /// that counts sees them.
    #[inline(always)]
    pub(super) fn read(&mut self, frame: &Frame, grid: &DoubledGrid, row: u32) {
        let place = self.place(row);
        if self.rows[place].replace(row) == Some(row) {
            return;
        }
        let region = grid.region();
        let inside = ((region.width - self.first_column) as usize).min(self.columns);
        let start = 3 * (region.x + self.first_column) as usize;
        let pixels = &frame.row(region.y + row)[start..start + 3 * inside];
        let [red, green, blue] = places_mut(&mut self.levels, self.columns, place);
        // One plain loop over pixels: for that, not for chunks of it, the compiler has instructions that split three ways.
        let channels = red.iter_mut().zip(green.iter_mut()).zip(blue.iter_mut());
        for (((red, green), blue), pixel) in channels.zip(pixels.as_chunks::<3>().0) {
            [*red, *green, *blue] = *pixel;
        }
        for channel in [red, green, blue] {
            let last = inside.checked_sub(1).map_or(0, |last| channel[last]);
            channel[inside..].fill(last);
        }
    }

    #[inline(always)]
    fn place(&self, row: u32) -> usize {
        row as usize & (self.rows.len() - 1)
    }

    /// A row that was read: R, then G, then B.
    #[inline(always)]
    pub(super) fn channels(&self, row: u32) -> &[u8] {
        &self.levels[3 * self.place(row) * self.columns..][..3 * self.columns]
    }

    /// One channel of a row that was read.
    #[inline(always)]
    pub(super) fn channel(&self, row: u32, channel: usize) -> &[u8] {
        let place = self.place(row);
        &self.levels[(3 * place + channel) * self.columns..][..self.columns]
    }
}

/// The three channels of a place.
#[inline(always)]
fn places_mut(levels: &mut [u8], columns: usize, place: usize) -> [&mut [u8]; 3] {
    let (red, rest) = levels[3 * place * columns..][..3 * columns].split_at_mut(columns);
    let (green, blue) = rest.split_at_mut(columns);
    [red, green, blue]
}
