//! Sums over every window of a stretch of one mask row, carried on to the next row.
//!
//! From one mask row to the next every column of a window gains the pixel that enters and loses the one that leaves:
//! V(Y + 1) = V(Y) + p[⌊(Y + h)/2⌋] − p[⌊Y/2⌋], whatever the parity of Y and h. The differences are summed over the
//! windows' columns ([`super::powers`]) and added to the windows' sums, so the work along x is done on differences; for
//! an even h two mask rows in succession share them.
//!
//! The three channels lie in one row, each with the columns under its last windows: a loop runs once for all of them.

use super::chunk::{Chunk, add, chunks, chunks_mut, fit, join};
use super::lane::Lane;
use super::planes::Planes;
use super::powers::{Powers, columns_under};

/// One quantity summed over windows, in all three channels.
#[derive(Clone, Debug, Default)]
pub(super) struct Running<T> {
    powers: Powers<T>,
    /// For windows on the first samples of columns, and on their second.
    totals: [Vec<T>; 2],
    changes: [Vec<T>; 2],
    /// The rows of pixels, entering and leaving, that `changes` come from.
    changed_by: Option<(u32, u32)>,
    /// The mask row that `totals` are of.
    row: Option<u32>,
    positions: usize,
    /// Columns of each channel.
    columns: usize,
}

impl<T: Lane> Running<T> {
    /// Prepares for windows of `side` samples at `positions` columns, in whole chunks.
    #[inline(always)]
    pub(super) fn fit(&mut self, positions: usize, side: u16) {
        self.columns = columns_under(positions, side);
        self.powers.fit(3 * self.columns, side);
        for buffer in self.totals.iter_mut().chain(&mut self.changes) {
            fit(buffer, 3 * self.columns);
        }
        (self.positions, self.changed_by, self.row) = (positions, None, None);
    }

    /// Columns of pixels that are read.
    #[inline(always)]
    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// The mask row that the totals are of.
    #[inline(always)]
    pub(super) fn row(&self) -> Option<u32> {
        self.row
    }

    /// Sums up mask row `y` from nothing: over `rows`, each with the number of its samples under the window.
    #[inline(always)]
    pub(super) fn begin(
        &mut self,
        y: u32,
        planes: &Planes,
        rows: impl Iterator<Item = (u32, u32)>,
        of: impl Fn(u8) -> T + Copy,
    ) {
        let columns = self.powers.columns();
        columns.fill(T::default());
        for (row, samples) in rows {
            let samples = T::from_i64(i64::from(samples));
            for (sum, levels) in chunks_mut(columns).iter_mut().zip(chunks(planes.channels(row))) {
                *sum = join(*sum, *levels, |sum, level| sum.plus(samples.times(of(level))));
            }
        }
        self.powers.build_into(&mut self.totals);
        (self.row, self.changed_by) = (Some(y), None);
    }

    /// Goes on to mask row `y`, where row `enter` of pixels comes in and row `leave` goes out; `change` is what that does
    /// to a sum.
    #[inline(always)]
    pub(super) fn descend(
        &mut self,
        y: u32,
        planes: &Planes,
        (enter, leave): (u32, u32),
        change: impl Fn(u8, u8) -> T + Copy,
    ) {
        if self.changed_by.replace((enter, leave)) != Some((enter, leave)) {
            let levels = chunks(planes.channels(enter)).iter().zip(chunks(planes.channels(leave)));
            for (column, (enter, leave)) in chunks_mut(self.powers.columns()).iter_mut().zip(levels) {
                *column = join(*enter, *leave, change);
            }
            self.powers.build_into(&mut self.changes);
        }
        for (totals, changes) in self.totals.iter_mut().zip(&self.changes) {
            let changes = chunks(&changes[..3 * self.columns]);
            for (sum, change) in chunks_mut(&mut totals[..3 * self.columns]).iter_mut().zip(changes) {
                *sum = add(*sum, *change);
            }
        }
        self.row = Some(y);
    }

    /// The sums of a channel: of the windows on the first samples of columns, and on their second.
    #[inline(always)]
    pub(super) fn windows(&self, channel: usize) -> [&[Chunk<T>]; 2] {
        let [on_first, on_second] = &self.totals;
        let first = channel * self.columns;
        [on_first, on_second].map(|sums| chunks(&sums[first..][..self.positions]))
    }
}
