//! A small binary picture cut out of a frame. Its morphology, parts and hull have files of their own.

mod hull;
mod judged;
mod morphology;
mod parts;
mod places;

pub(crate) use hull::{enclosing_rectangle_area, polygon_area_and_centroid};
pub(crate) use judged::Judge;

use std::fmt;
use std::ops::Range;

use super::memory::{List, Memory};
use crate::bitmask::{Run, each_run, words_of_run};
use crate::geometry::RectPx;

/// Set and unset pixels of a rectangle of the frame, in memory of a landmark's turn or of the work on a seed; what is made
/// of it is made there, too.
///
/// Rows are of 64-bit words, as those of a [`BitMask`](crate::bitmask::BitMask), but dense: all are looked at. Bits beyond
/// the last column are never set.
pub(crate) struct Patch<'m> {
    /// Which part of the frame.
    pub(crate) rect: RectPx,
    words_per_row: usize,
    words: &'m mut [u64],
    memory: &'m Memory,
}

impl<'m> Patch<'m> {
    pub(crate) fn empty(memory: &'m Memory, rect: RectPx) -> Self {
        let words_per_row = rect.width.div_ceil(64) as usize;
        let words = memory.alloc_slice_fill_copy(words_per_row * rect.height as usize, 0);
        Self { rect, words_per_row, words, memory }
    }

    /// The same in other memory.
    pub(crate) fn copy_in<'k>(&self, memory: &'k Memory) -> Patch<'k> {
        let Self { rect, words_per_row, .. } = *self;
        Patch { rect, words_per_row, words: memory.alloc_slice_copy(self.words), memory }
    }

    /// The same again.
    fn copy(&self) -> Self {
        self.copy_in(self.memory)
    }

    /// Where it lies.
    pub(crate) fn memory(&self) -> &'m Memory {
        self.memory
    }

    /// The pixels of `runs`, whose coordinates count from the corner of `origin`; those outside `rect` are left out.
    pub(crate) fn from_runs<'r>(
        memory: &'m Memory,
        rect: RectPx,
        origin: RectPx,
        runs: impl Iterator<Item = &'r Run>,
    ) -> Self {
        let mut patch = Self::empty(memory, rect);
        for run in runs {
            let y = (origin.y + run.y).wrapping_sub(rect.y);
            let column = |x: u32| (origin.x + x).saturating_sub(rect.x).min(rect.width);
            if y < rect.height {
                patch.set_run(y, column(run.x_start), column(run.x_end));
            }
        }
        patch
    }

    /// The pixels for which `keep` holds.
    pub(crate) fn from_fn(memory: &'m Memory, rect: RectPx, mut keep: impl FnMut(i32, i32) -> bool) -> Self {
        let mut patch = Self::empty(memory, rect);
        for y in 0..rect.height {
            let row = patch.row_mut(y);
            for (start, word) in (0..).step_by(64).zip(row) {
                for x in start..(start + 64).min(rect.width) {
                    *word |= u64::from(keep(x as i32, y as i32)) << (x - start);
                }
            }
        }
        patch
    }

    pub(crate) fn set(&mut self, x: i32, y: i32) {
        debug_assert!((0..self.width()).contains(&x), "column {x} is outside the patch");
        self.row_mut(y as u32)[x as usize / 64] |= 1 << (x % 64);
    }

    fn set_run(&mut self, y: u32, x_start: u32, x_end: u32) {
        let row = self.row_mut(y);
        words_of_run(x_start, x_end).for_each(|(word, bits)| row[word as usize] |= bits);
    }

    /// Words in a row.
    #[inline(always)]
    pub(crate) fn words_in_row(&self) -> usize {
        self.words_per_row
    }

    /// Columns `64 * at` and onwards of a row, the first in bit 0.
    #[inline(always)]
    pub(crate) fn word(&self, y: i32, at: usize) -> u64 {
        self.words[y as usize * self.words_per_row + at]
    }

    fn row(&self, y: u32) -> &[u64] {
        &self.words[y as usize * self.words_per_row..][..self.words_per_row]
    }

    fn row_mut(&mut self, y: u32) -> &mut [u64] {
        &mut self.words[y as usize * self.words_per_row..][..self.words_per_row]
    }

    pub(crate) fn width(&self) -> i32 {
        self.rect.width as i32
    }

    pub(crate) fn height(&self) -> i32 {
        self.rect.height as i32
    }

    /// Whether a pixel is set; outside the patch none is.
    pub(crate) fn get(&self, x: i32, y: i32) -> bool {
        (0..self.width()).contains(&x)
            && (0..self.height()).contains(&y)
            && self.row(y as u32)[x as usize / 64] >> (x % 64) & 1 == 1
    }

    pub(crate) fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// All runs of set pixels, from the top, each row from the left.
    pub(crate) fn runs(&self) -> List<'m, Run> {
        let mut runs = List::with_capacity_in(2 * self.rect.height as usize, self.memory);
        self.each_run(|run| runs.push(run));
        runs
    }

    /// Gives them one by one.
    pub(crate) fn each_run(&self, each: impl FnMut(Run)) {
        self.each_run_of(0..self.rect.height, each);
    }

    /// Gives those of some rows one by one.
    pub(crate) fn each_run_of(&self, rows: Range<u32>, mut each: impl FnMut(Run)) {
        for y in rows {
            each_run(y, (0, self.row(y)), self.rect.width, &mut each);
        }
    }

    /// The set pixels among columns `left..left + 64` of a row, the first in bit 0.
    #[inline]
    pub(crate) fn bits_from(&self, left: i32, y: i32) -> u64 {
        if !(0..self.height()).contains(&y) {
            return 0;
        }
        let row = self.row(y as u32);
        // What lies left of the patch has no word either: its number is beyond all.
        let word = |at: i32| row.get(at as usize).copied().unwrap_or(0);
        let (at, shift) = (left >> 6, left & 63);
        word(at) >> shift | word(at + 1) << 1 << (63 - shift)
    }

    /// The rectangle around the set pixels, in the frame; `None` of nothing.
    pub(crate) fn bounds(&self) -> Option<RectPx> {
        let (mut left, mut top, mut right, mut bottom) = (u32::MAX, u32::MAX, 0, 0);
        for y in 0..self.rect.height {
            for (first, word) in (0..).step_by(64).zip(self.row(y)).filter(|(_, word)| **word != 0) {
                (left, top) = (left.min(first + word.trailing_zeros()), top.min(y));
                (right, bottom) = (right.max(first + 64 - word.leading_zeros()), y + 1);
            }
        }
        let (x, y) = (self.rect.x.wrapping_add(left), self.rect.y.wrapping_add(top));
        (left < right).then(|| RectPx { x, y, width: right - left, height: bottom - top })
    }

    /// Whether a set pixel lies on the border of a picture of that size.
    pub(crate) fn touches_border(&self, width: u32, height: u32) -> bool {
        self.bounds().is_some_and(|bounds| {
            bounds.x == 0
                || bounds.y == 0
                || bounds.x + bounds.width == width
                || bounds.y + bounds.height == height
        })
    }
}

impl PartialEq for Patch<'_> {
    /// Equal places and pixels, wherever they lie.
    fn eq(&self, other: &Self) -> bool {
        self.rect == other.rect && self.words == other.words
    }
}

impl fmt::Debug for Patch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rect, words_per_row: _, words, memory: _ } = self;
        f.debug_struct("Patch").field("rect", rect).field("words", words).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PointPx;

    const RECT: RectPx = RectPx { x: 10, y: 20, width: 12, height: 9 };

    fn ring(memory: &Memory) -> Patch<'_> {
        Patch::from_fn(memory, RECT, |x, y| (2..9).contains(&x) && (2..8).contains(&y) && (x, y) != (5, 5))
    }

    #[test]
    fn holes_are_filled_and_nothing_else() {
        let memory = Memory::new();
        assert_eq!(ring(&memory).count(), 41);
        assert_eq!(ring(&memory).filled().count(), 42);
    }

    #[test]
    fn opening_takes_whiskers_away() {
        let memory = Memory::new();
        let plain = ring(&memory).filled();
        let whiskered =
            Patch::from_fn(&memory, RECT, |x, y| plain.get(x, y) || ((9..11).contains(&x) && y == 5));
        assert_eq!(whiskered.opened(1), plain);
    }

    #[test]
    fn the_hull_of_a_rectangle_is_the_rectangle() {
        let memory = Memory::new();
        let hull = ring(&memory).hull();
        assert_eq!(hull.len(), 4);
        let (area, centre) = polygon_area_and_centroid(&hull).unwrap();
        assert_eq!((area, centre), (42.0, PointPx::new(15.5, 25.0)));
    }

    #[test]
    fn a_disc_fills_less_of_its_rectangle_than_a_leaning_rectangle() {
        let memory = Memory::new();
        let rect = RectPx { x: 3, y: 4, width: 60, height: 60 };
        let leaning = Patch::from_fn(&memory, rect, |x, y| (x + y - 60).abs() < 12 && (x - y).abs() < 30);
        let disc = Patch::from_fn(&memory, rect, |x, y| (x - 30).pow(2) + (y - 30).pow(2) < 400);
        let fill = |patch: &Patch<'_>| {
            let hull = patch.hull();
            polygon_area_and_centroid(&hull).unwrap().0 / enclosing_rectangle_area(&hull)
        };
        assert!(
            fill(&leaning) > 0.93 && (0.74..0.86).contains(&fill(&disc)),
            "{} {}",
            fill(&leaning),
            fill(&disc)
        );
    }

    #[test]
    fn the_part_with_the_seed_is_kept() {
        let memory = Memory::new();
        let two = Patch::from_fn(&memory, RECT, |x, _| !(3..=8).contains(&x));
        let seed = Patch::from_fn(&memory, RECT, |x, y| x == 10 && y == 4);
        assert_eq!(two.parts_overlapping(&seed, 1.0).unwrap().count(), 27);
    }
}
