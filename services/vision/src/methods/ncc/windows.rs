//! Variances of the windows of a region, from running sums in whole numbers, and the scores that follow from them.
//!
//! From one row of windows to the next every column gains the pixel that enters and loses the one that leaves. Running
//! totals over the columns then give each window by one difference.

use crate::geometry::SizePx;
use crate::mask::{Lanes, Work};

use super::levels::Levels;

/// A window's Σ(f − f̄)², in levels² over all its samples, that is not above this belongs to equal levels: nothing can be
/// said of it.
pub(super) const FLAT: f64 = 0.5;

/// Σ(f − f̄)² of the windows of a region, row after row.
#[derive(Clone, Debug, Default)]
pub(super) struct WindowSums {
    lanes: Lanes,
    window: SizePx,
    channels: Vec<Columns>,
    variances: Vec<f64>,
}

/// One channel's sums over the pixels of each column that lie under the windows, and their running totals, which begin
/// with 0. A column's fit because windows are at most 65,535 pixels high.
#[derive(Clone, Debug, Default)]
struct Columns {
    levels: Vec<u32>,
    squares: Vec<u32>,
    level_totals: Vec<u64>,
    square_totals: Vec<u64>,
}

impl WindowSums {
    /// Prepares for windows of that size, which must fit the region.
    pub(super) fn begin(&mut self, levels: &Levels, window: SizePx) {
        self.window = window;
        let width = levels.size().width as usize;
        self.channels.resize_with(levels.channels(), Columns::default);
        for (number, columns) in self.channels.iter_mut().enumerate() {
            columns.clear(width);
            for row in 0..window.height {
                self.lanes.run(Enter { columns, row: levels.row(number, row) });
            }
        }
        self.variances.resize(width + 1 - window.width as usize, 0.0);
    }

    /// Makes `scores`, which hold the numerators of eq. 2.22 of the windows whose first row is `y`, the quotients: `norm` is
    /// √Σ(h − h̄)². Rows must come in order, from 0.
    pub(super) fn divide(&mut self, levels: &Levels, y: u32, norm: f32, scores: &mut [f32]) {
        self.variances.fill(0.0);
        let samples = f64::from(self.window.width) * f64::from(self.window.height);
        let window = self.window.width as usize;
        for (number, columns) in self.channels.iter_mut().enumerate() {
            if y > 0 {
                let leaving = levels.row(number, y - 1);
                let entering = levels.row(number, y + self.window.height - 1);
                self.lanes.run(Descend { columns, entering, leaving });
            }
            self.lanes.run(AddVariances { columns, window, samples, variances: &mut self.variances });
        }
        self.lanes.run(Divide { scores, variances: &self.variances, norm });
    }
}

impl Columns {
    fn clear(&mut self, width: usize) {
        for sums in [&mut self.levels, &mut self.squares] {
            sums.clear();
            sums.resize(width, 0);
        }
        for totals in [&mut self.level_totals, &mut self.square_totals] {
            totals.clear();
            totals.resize(width + 1, 0);
        }
    }
}

struct Enter<'a> {
    columns: &'a mut Columns,
    row: &'a [u8],
}

impl Work for Enter<'_> {
    #[inline(always)]
    fn run(self) {
        let sums = self.columns.levels.iter_mut().zip(&mut self.columns.squares);
        for ((sum, square), &level) in sums.zip(self.row) {
            let level = u32::from(level);
            (*sum, *square) = (*sum + level, *square + level * level);
        }
    }
}

struct Descend<'a> {
    columns: &'a mut Columns,
    entering: &'a [u8],
    leaving: &'a [u8],
}

impl Work for Descend<'_> {
    #[inline(always)]
    fn run(self) {
        let sums = self.columns.levels.iter_mut().zip(&mut self.columns.squares);
        for ((sum, square), (&new, &old)) in sums.zip(self.entering.iter().zip(self.leaving)) {
            let (new, old) = (u32::from(new), u32::from(old));
            *sum = (*sum + new) - old;
            *square = (*square - old * old) + new * new;
        }
    }
}

/// Adds the windows' Σf² − (Σf)²/n.
struct AddVariances<'a> {
    columns: &'a mut Columns,
    window: usize,
    samples: f64,
    variances: &'a mut [f64],
}

impl Work for AddVariances<'_> {
    #[inline(always)]
    fn run(self) {
        let Columns { levels, squares, level_totals, square_totals } = self.columns;
        let (mut level_total, mut square_total) = (0, 0);
        let totals = level_totals[1..].iter_mut().zip(&mut square_totals[1..]);
        for ((level_after, square_after), (&level, &square)) in totals.zip(levels.iter().zip(&*squares)) {
            (level_total, square_total) = (level_total + u64::from(level), square_total + u64::from(square));
            (*level_after, *square_after) = (level_total, square_total);
        }
        let (count, one_sample) = (self.variances.len(), 1.0 / self.samples);
        let (left, right) = (&level_totals[..count], &level_totals[self.window..][..count]);
        let (square_left, square_right) = (&square_totals[..count], &square_totals[self.window..][..count]);
        for x in 0..count {
            let (sum, square) = ((right[x] - left[x]) as f64, (square_right[x] - square_left[x]) as f64);
            self.variances[x] += square - sum * sum * one_sample;
        }
    }
}

struct Divide<'a> {
    scores: &'a mut [f32],
    variances: &'a [f64],
    norm: f32,
}

impl Work for Divide<'_> {
    #[inline(always)]
    fn run(self) {
        for (score, &variance) in self.scores.iter_mut().zip(self.variances) {
            let quotient = (*score / ((variance as f32).sqrt() * self.norm)).clamp(-1.0, 1.0);
            *score = if variance > FLAT { quotient } else { 0.0 };
        }
    }
}
