//! Sums over the columns of a window.
//!
//! With B(x) the sum of m = ⌊w/2⌋ columns from x and c(x) one column, a window of width w sums to
//!
//! | | starts on the first sample of x | starts on its second sample |
//! | --- | --- | --- |
//! | w even | 2 B(x) | 2 B(x) − c(x) + c(x + m) |
//! | w odd | 2 B(x) + c(x + m) | 2 B(x) − c(x) + 2 c(x + m) |
//!
//! B is put together from sums of 1, 2, 4 … columns, each level twice the one before it: a handful of steps over whole
//! chunks, where a running sum would go one column after another.

use super::chunk::{WIDTH, add, chunks, chunks_mut, fit, join, whole_chunks};
use super::lane::Lane;

/// Column sums of a row of windows, and sums of 2ᵏ neighbouring ones for every k that B needs.
#[derive(Clone, Debug, Default)]
pub(super) struct Powers<T> {
    levels: Vec<Vec<T>>,
    /// B.
    lesser: Vec<T>,
    /// Columns, in whole chunks, that every level covers; what windows at the last of them cover beyond is arbitrary.
    covered: usize,
    half: usize,
    odd: T,
}

impl<T: Lane> Powers<T> {
    /// Prepares for windows of `side` samples over so many columns, in whole chunks.
    #[inline(always)]
    pub(super) fn fit(&mut self, columns: usize, side: u16) {
        self.half = usize::from(side) / 2;
        self.odd = T::from_i64(i64::from(side % 2));
        self.covered = columns;
        let levels = self.half.checked_ilog2().map_or(1, |largest| largest as usize + 1);
        if self.levels.len() < levels {
            self.levels.resize_with(levels, Vec::new);
        }
        for level in &mut self.levels {
            fit(level, self.covered + self.half + WIDTH);
        }
        fit(&mut self.lesser, self.covered);
    }

    /// The column sums, to be set.
    #[inline(always)]
    pub(super) fn columns(&mut self) -> &mut [T] {
        &mut self.levels[0][..self.covered]
    }

    /// Sums the column sums over every window: those that start on the first samples of columns, and on their second.
    #[inline(always)]
    pub(super) fn build_into(&mut self, [on_first, on_second]: &mut [Vec<T>; 2]) {
        self.build();
        let columns = &self.levels[0];
        let first_columns = chunks(&columns[..self.covered]).iter();
        let next_columns = chunks(&columns[self.half..][..self.covered]).iter();
        let sums = chunks(&self.lesser[..self.covered]).iter().zip(first_columns).zip(next_columns);
        let on_first = chunks_mut(&mut on_first[..self.covered]).iter_mut();
        let windows = on_first.zip(chunks_mut(&mut on_second[..self.covered]));
        for ((on_first, on_second), ((lesser, first_column), next_column)) in windows.zip(sums) {
            let twice = add(*lesser, *lesser);
            *on_first = join(twice, *next_column, |sum, next| sum.plus(self.odd.times(next)));
            *on_second = join(join(*on_first, *next_column, T::plus), *first_column, T::minus);
        }
    }

    /// B at all columns that were to be covered.
    #[inline(always)]
    pub(super) fn lesser_sums(&self) -> &[T] {
        &self.lesser[..self.covered]
    }

    /// Sums neighbouring columns.
    #[inline(always)]
    pub(super) fn build(&mut self) {
        let mut length = 1;
        for level in 1..self.levels.len() {
            if 2 * length > self.half {
                break;
            }
            let (lower, upper) = self.levels.split_at_mut(level);
            let (left, right) =
                (&lower[level - 1][..self.covered], &lower[level - 1][length..][..self.covered]);
            let sums = chunks_mut(&mut upper[0][..self.covered]).iter_mut();
            for (sum, (left, right)) in sums.zip(chunks(left).iter().zip(chunks(right))) {
                *sum = add(*left, *right);
            }
            length *= 2;
        }
        self.sum_lesser();
    }

    /// B from the levels whose bit is set in m: the first one's sums, then the others' behind it.
    #[inline(always)]
    fn sum_lesser(&mut self) {
        let lesser = &mut self.lesser[..self.covered];
        let mut from = 0;
        for (level, sums) in self.levels.iter().enumerate().filter(|(level, _)| self.half & 1 << level != 0) {
            let part = &sums[from..from + lesser.len()];
            if from == 0 {
                lesser.copy_from_slice(part);
            } else {
                let sums = chunks_mut(lesser).iter_mut().zip(chunks(part));
                sums.for_each(|(sum, more)| *sum = add(*sum, *more));
            }
            from += 1 << level;
        }
        if self.half == 0 {
            lesser.fill(T::default());
        }
    }
}

/// Columns, in whole chunks, under windows of `side` samples that start at so many of them.
#[inline(always)]
pub(super) fn columns_under(positions: usize, side: u16) -> usize {
    whole_chunks(positions + usize::from(side) / 2 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doubled_grid::DoubledGrid;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn windows_sum_their_weighted_columns(side in 1u16..200, seed in 1u32..1000) {
            let mut powers = Powers::<i32>::default();
            powers.fit(columns_under(64, side), side);
            let levels: Vec<i32> = (0..powers.columns().len() as u32).map(|x| (x * seed % 251) as i32).collect();
            powers.columns().copy_from_slice(&levels);
            let mut sums = [vec![0; levels.len()], vec![0; levels.len()]];
            powers.build_into(&mut sums);
            for (phase, sums) in (0..).zip(&sums) {
                for (start, &sum) in (phase..).step_by(2).zip(sums).take(64) {
                    let expected: i32 = DoubledGrid::pixels_under(start, side)
                        .map(|at| DoubledGrid::samples_on(at, start, side) as i32 * levels[at as usize]).sum();
                    prop_assert_eq!(sum, expected);
                }
            }
        }
    }
}
