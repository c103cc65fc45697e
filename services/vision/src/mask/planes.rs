//! Rows of pixels, split into their three channels.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::aligned::Aligned;
use super::chunk::{add, chunks, chunks_mut, join};
use super::lane::Lane;

/// Levels of R, G and B of a stretch of those rows of the region that lie under one window.
#[derive(Clone, Debug, Default)]
pub(super) struct Planes {
    /// Row after row, each as R, G, B; row r in place r modulo the number of places.
    levels: Aligned<u8>,
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
        self.levels.fit(3 * columns * self.rows.len());
    }

    /// Reads row `row` of the region, if it is not there yet. Columns beyond the region repeat the last one; no window
    /// that counts sees them.
    #[inline(always)]
    pub(super) fn read(&mut self, frame: &Frame, grid: &DoubledGrid, row: u32) {
        let place = self.place(row);
        if self.rows[place].replace(row) == Some(row) {
            return;
        }
        let pixels = inside(frame, grid, row, self.first_column, self.columns);
        let [red, green, blue] = places_mut(&mut self.levels, self.columns, place);
        // One plain loop over pixels: for that, not for chunks of it, the compiler has instructions that split three ways.
        let levels = red.iter_mut().zip(green.iter_mut()).zip(blue.iter_mut());
        for (((red, green), blue), pixel) in levels.zip(pixels) {
            [*red, *green, *blue] = *pixel;
        }
        for channel in [red, green, blue] {
            repeat_last(channel, pixels.len());
        }
    }

    /// Makes `sums`, of the rows that begin with row `last`, those of `of` over `rows` of one channel, all of them read; from
    /// nothing where these do not begin one row below.
    #[inline(always)]
    pub(super) fn sum_rows(
        &self,
        sums: &mut [i16],
        last: Option<u32>,
        rows: Range<u32>,
        channel: usize,
        of: impl Fn(u8) -> i16 + Copy,
    ) {
        if let Some(left) = last.filter(|last| last + 1 == rows.start) {
            let (entering, leaving) = (self.channel(rows.end - 1, channel), self.channel(left, channel));
            let levels = chunks(entering).iter().zip(chunks(leaving));
            for (sum, (enter, leave)) in chunks_mut(sums).iter_mut().zip(levels) {
                let change = join(*enter, *leave, |enter, leave| of(enter).minus(of(leave)));
                *sum = add(*sum, change);
            }
            return;
        }
        sums.fill(0);
        for row in rows {
            for (sum, levels) in chunks_mut(sums).iter_mut().zip(chunks(self.channel(row, channel))) {
                *sum = join(*sum, *levels, |sum: i16, level| sum.plus(of(level)));
            }
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

/// Makes `levels` one channel of row `row` of the region from column `first` on; as [`Planes::read`] says.
#[inline(always)]
pub(super) fn read_channel(
    frame: &Frame,
    grid: &DoubledGrid,
    row: u32,
    first: u32,
    channel: usize,
    levels: &mut [u8],
) {
    let pixels = inside(frame, grid, row, first, levels.len());
    // The channel's number must be known where the loop is compiled.
    match channel {
        0 => levels.iter_mut().zip(pixels).for_each(|(level, pixel)| *level = pixel[0]),
        1 => levels.iter_mut().zip(pixels).for_each(|(level, pixel)| *level = pixel[1]),
        _ => levels.iter_mut().zip(pixels).for_each(|(level, pixel)| *level = pixel[2]),
    }
    repeat_last(levels, pixels.len());
}

/// The pixels of row `row` of the region from column `first` on, at most so many.
#[inline(always)]
fn inside<'f>(frame: &'f Frame, grid: &DoubledGrid, row: u32, first: u32, columns: usize) -> &'f [[u8; 3]] {
    let region = grid.region();
    let count = ((region.width - first) as usize).min(columns);
    let start = 3 * (region.x + first) as usize;
    frame.row(region.y + row)[start..start + 3 * count].as_chunks().0
}

/// Repeats the last of `count` levels to the end.
#[inline(always)]
fn repeat_last(levels: &mut [u8], count: usize) {
    let last = count.checked_sub(1).map_or(0, |last| levels[last]);
    levels[count..].fill(last);
}

/// The three channels of a place.
#[inline(always)]
fn places_mut(levels: &mut [u8], columns: usize, place: usize) -> [&mut [u8]; 3] {
    let (red, rest) = levels[3 * place * columns..][..3 * columns].split_at_mut(columns);
    let (green, blue) = rest.split_at_mut(columns);
    [red, green, blue]
}
