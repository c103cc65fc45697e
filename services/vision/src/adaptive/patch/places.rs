//! The set pixels of a patch, one after the other.

use super::Patch;

/// The places of set pixels in a patch, from the top, each row from the left.
#[derive(Clone)]
pub(crate) struct Places<'a> {
    /// Those after the one that is being gone through.
    words: &'a [u64],
    /// What is left of that one, its first column and its row.
    bits: u64,
    left: i32,
    y: i32,
    /// Where rows end, in whole words.
    end: i32,
}

impl Patch<'_> {
    /// The set pixels' places in the patch.
    pub(crate) fn set_places(&self) -> Places<'_> {
        let end = 64 * self.words_per_row as i32;
        Places { words: self.words, bits: 0, left: end - 64, y: -1, end }
    }
}

impl Places<'_> {
    fn next_word(&mut self) -> Option<()> {
        let (&bits, words) = self.words.split_first()?;
        (self.bits, self.words) = (bits, words);
        self.left += 64;
        if self.left >= self.end {
            (self.left, self.y) = (0, self.y + 1);
        }
        Some(())
    }
}

impl Iterator for Places<'_> {
    type Item = (i32, i32);

    #[inline]
    fn next(&mut self) -> Option<(i32, i32)> {
        while self.bits == 0 {
            self.next_word()?;
        }
        let bit = self.bits.trailing_zeros() as i32;
        self.bits &= self.bits - 1;
        Some((self.left + bit, self.y))
    }

    #[inline]
    fn nth(&mut self, mut skipped: usize) -> Option<(i32, i32)> {
        if skipped == 0 {
            return self.next();
        }
        while self.bits.count_ones() as usize <= skipped {
            skipped -= self.bits.count_ones() as usize;
            self.next_word()?;
        }
        for _ in 0..skipped {
            self.bits &= self.bits - 1;
        }
        self.next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adaptive::memory::Memory;
    use crate::geometry::RectPx;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_set_pixel_is_passed_in_order(
            width in 0u32..150, height in 0u32..12, step in 1usize..90,
            set in prop::collection::vec(prop::bool::weighted(0.3), 1800),
        ) {
            let (memory, rect) = (Memory::new(), RectPx { x: 3, y: 4, width, height });
            let is_set = |x: i32, y: i32| set[(y * width as i32 + x) as usize];
            let patch = Patch::from_fn(&memory, rect, is_set);
            let all = (0..height as i32).flat_map(|y| (0..width as i32).map(move |x| (x, y)));
            let slowly: Vec<(i32, i32)> = all.filter(|&(x, y)| is_set(x, y)).collect();
            prop_assert_eq!(patch.set_places().collect::<Vec<_>>(), slowly.clone());
            let thinned: Vec<(i32, i32)> = slowly.into_iter().step_by(step).collect();
            prop_assert_eq!(patch.set_places().step_by(step).collect::<Vec<_>>(), thinned);
        }
    }
}
