//! Sums over every window of a stretch of one mask row, carried on to the next row.
//!
//! From one mask row to the next every column of a window gains the pixel that enters and loses the one that leaves:
//! V(Y + 1) = V(Y) + p[⌊(Y + h)/2⌋] − p[⌊Y/2⌋], whatever the parity of Y and h. The differences are summed over the
//! windows' columns ([`super::powers`]) and added to the windows' sums, so the work along x is done on differences; for
//! an even h two mask rows in succession share them.

use super::chunk::{Chunk, WIDTH, add, fit, join, load, store};
use super::lane::Lane;
use super::planes::Planes;
use super::powers::Powers;

/// Sums of the windows at 32 neighbouring columns: those on the first, and on the second sample of each column.
pub(super) type Windows<T> = [Chunk<T>; 2];

/// One quantity summed over windows, in all three channels.
#[derive(Clone, Debug, Default)]
pub(super) struct Running<T> {
    powers: Powers<T>,
    totals: [[Vec<T>; 2]; 3],
    changes: [[Vec<T>; 2]; 3],
    /// The rows of pixels, entering and leaving, that `changes` come from.
    changed_by: Option<(u32, u32)>,
    /// The mask row that `totals` are of.
    row: Option<u32>,
    positions: usize,
}

impl<T: Lane> Running<T> {
    /// Prepares for windows of `side` samples at `positions` columns, in whole chunks.
    #[inline(always)]
    pub(super) fn fit(&mut self, positions: usize, side: u16) {
        self.powers.fit(positions, side);
        for buffer in self.totals.iter_mut().chain(&mut self.changes).flatten() {
            fit(buffer, positions);
        }
        (self.positions, self.changed_by, self.row) = (positions, None, None);
    }

    /// Columns of pixels that are read.
    #[inline(always)]
    pub(super) fn columns(&mut self) -> usize {
        self.powers.columns().len()
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
        rows: &(impl Iterator<Item = (u32, u32)> + Clone),
        of: impl Fn(u8) -> T + Copy,
    ) {
        for channel in 0..3 {
            let columns = self.powers.columns();
            columns.fill(T::default());
            for (row, samples) in rows.clone() {
                let (plane, samples) = (planes.channel(row, channel), T::from_i64(i64::from(samples)));
                for x in (0..columns.len()).step_by(WIDTH) {
                    let more = join(load(columns, x), load(plane, x), |sum, level| {
                        sum.plus(samples.times(of(level)))
                    });
                    store(columns, x, more);
                }
            }
            self.powers.build_into(&mut self.totals[channel], self.positions);
        }
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
            for channel in 0..3 {
                let (entering, leaving) = (planes.channel(enter, channel), planes.channel(leave, channel));
                let columns = self.powers.columns();
                for x in (0..columns.len()).step_by(WIDTH) {
                    store(columns, x, join(load(entering, x), load(leaving, x), change));
                }
                self.powers.build_into(&mut self.changes[channel], self.positions);
            }
        }
        for (totals, changes) in self.totals.iter_mut().flatten().zip(self.changes.iter().flatten()) {
            for x in (0..self.positions).step_by(WIDTH) {
                let sums = add(load(totals, x), load(changes, x));
                store(totals, x, sums);
            }
        }
        self.row = Some(y);
    }

    /// The sums of a channel at the 32 columns from `x`.
    #[inline(always)]
    pub(super) fn windows(&self, channel: usize, x: usize) -> Windows<T> {
        let [on_first, on_second] = &self.totals[channel];
        [load(on_first, x), load(on_second, x)]
    }
}
