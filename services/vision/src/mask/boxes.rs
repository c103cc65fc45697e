//! Sums over the columns of a window.
//!
//! With B(x) and C(x) the sums of ⌊w/2⌋ and ⌈w/2⌉ columns from x, a window of width w that starts on the first sample
//! of pixel x sums to B(x) + C(x), one that starts on its second sample to C(x) + B(x + 1), whatever the parity of w.
//! B itself is put together from sums of 1, 2, 4 … columns, each twice the one before it: a handful of passes that
//! the compiler turns into vector code, where a running sum would go one element after another.

use super::lane::Lane;

/// Work space of [`Boxes::windows`].
#[derive(Default)]
pub(super) struct Boxes<T> {
    /// Sums of 2ᵏ columns, and of the next power.
    power: Vec<T>,
    next_power: Vec<T>,
    /// B and C.
    lesser: Vec<T>,
    greater: Vec<T>,
}

impl<T: Lane> Boxes<T> {
    /// Sums of the windows of `side` samples that start on the first and on the second sample of each of the first
    /// `positions` columns.
    #[inline(always)]
    pub(super) fn windows(&mut self, columns: &[T], side: u16, positions: usize, windows: &mut [Vec<T>; 2]) {
        let half = usize::from(side) / 2;
        self.sum_lesser(columns, half, positions + 1);
        let lesser = &self.lesser[..=positions];
        let greater = if side.is_multiple_of(2) {
            &lesser[..positions]
        } else {
            fit(&mut self.greater, positions);
            for ((greater, &lesser), &column) in self.greater.iter_mut().zip(lesser).zip(&columns[half..]) {
                *greater = lesser.plus(column);
            }
            &self.greater[..]
        };
        let [on_first, on_second] = windows;
        for ((window, &lesser), &greater) in on_first.iter_mut().zip(lesser).zip(greater) {
            *window = lesser.plus(greater);
        }
        for ((window, &lesser), &greater) in on_second.iter_mut().zip(&lesser[1..]).zip(greater) {
            *window = lesser.plus(greater);
        }
    }

    /// B of the first `count` columns.
    #[inline(always)]
    fn sum_lesser(&mut self, columns: &[T], half: usize, count: usize) {
        fit(&mut self.lesser, count);
        self.lesser.fill(T::default());
        fit(&mut self.power, columns.len());
        fit(&mut self.next_power, columns.len());
        self.power.copy_from_slice(columns);
        let (mut offset, mut length, mut valid) = (0, 1, columns.len());
        while length <= half {
            if half & length != 0 {
                for (sum, &part) in self.lesser.iter_mut().zip(&self.power[offset..valid]) {
                    *sum = sum.plus(part);
                }
                offset += length;
            }
            valid -= length;
            for ((next, &left), &right) in
                self.next_power[..valid].iter_mut().zip(&self.power).zip(&self.power[length..])
            {
                *next = left.plus(right);
            }
            std::mem::swap(&mut self.power, &mut self.next_power);
            length *= 2;
        }
    }
}

/// Makes `buffer` that long; what it holds afterwards is arbitrary.
#[inline(always)]
pub(super) fn fit<T: Copy + Default>(buffer: &mut Vec<T>, length: usize) {
    if buffer.len() != length {
        buffer.resize(length, T::default());
    }
}
