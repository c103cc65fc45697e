//! Growing and shrinking a patch, 64 pixels at a time.

use super::Patch;

impl Patch<'_> {
    /// Grown by `reach` pixels in all eight directions.
    pub(crate) fn dilated(&self, reach: i32) -> Self {
        let mut grown = self.copy();
        grown.grow(reach);
        grown
    }

    /// Grows as [`dilated`](Self::dilated) says.
    fn grow(&mut self, reach: i32) {
        let across = self.memory.alloc_slice_fill_copy(self.words.len(), 0);
        let mut done = 0;
        while done < reach {
            // What has grown by `done` reaches that far to the inside even where the border cut the rest of it off, so the
            // next step leaves no gap when it is one more.
            let step = (reach - done).min(done + 1).min(63);
            self.spread_across(step as u32, across);
            self.spread_along(step as usize, across);
            done += step;
        }
    }

    /// Makes `across` the set pixels and those `step` columns to both sides of them.
    fn spread_across(&self, step: u32, across: &mut [u64]) {
        let Some(last) = self.words_per_row.checked_sub(1) else { return };
        let columns = self.columns_of(last);
        let rows = self.words.chunks_exact(last + 1);
        for (row, across) in rows.zip(across.chunks_exact_mut(last + 1)) {
            let mut left = 0;
            for (at, across) in across.iter_mut().enumerate() {
                let (own, right) = (row[at], if at < last { row[at + 1] } else { 0 });
                *across = own | own << step | left >> (64 - step) | own >> step | right << (64 - step);
                left = own;
            }
            across[last] &= columns;
        }
    }

    /// Sets the pixels of `across` and those `step` rows up and down from them.
    fn spread_along(&mut self, step: usize, across: &[u64]) {
        let step = (step * self.words_per_row).min(across.len());
        let or = |words: &mut [u64], others: &[u64]| {
            words.iter_mut().zip(others).for_each(|(word, other)| *word |= other);
        };
        or(self.words, across);
        or(self.words, &across[step..]);
        or(&mut self.words[step..], across);
    }

    /// The bits of a word that are columns of the patch.
    fn columns_of(&self, word: usize) -> u64 {
        let columns = self.rect.width - 64 * word as u32;
        if columns >= 64 { u64::MAX } else { (1 << columns) - 1 }
    }

    /// Shrunk by `reach` pixels in all eight directions. The patch's own border does not shrink it, so that an object
    /// cut by the picture's edge keeps its core.
    pub(crate) fn eroded(&self, reach: i32) -> Self {
        let mut shrunk = self.inverted();
        shrunk.grow(reach);
        shrunk.invert();
        shrunk
    }

    /// Eroded and dilated again: thin attachments are gone.
    pub(crate) fn opened(&self, reach: i32) -> Self {
        let mut opened = self.eroded(reach);
        opened.grow(reach);
        opened.combine_with(self, |opened, own| opened & own);
        opened
    }

    /// Sets what is not set, and the other way round.
    fn invert(&mut self) {
        for y in 0..self.rect.height {
            for at in 0..self.words_per_row {
                let columns = self.columns_of(at);
                let word = &mut self.row_mut(y)[at];
                *word = !*word & columns;
            }
        }
    }

    /// The pixels of the rectangle that are not set.
    pub(crate) fn inverted(&self) -> Self {
        let mut inverted = self.copy();
        inverted.invert();
        inverted
    }

    /// The pixels set here and not in `other`, a patch of the same rectangle.
    pub(crate) fn without(&self, other: &Patch<'_>) -> Self {
        self.combined(other, |own, other| own & !other)
    }

    /// The pixels set here and in `other`, a patch of the same rectangle.
    pub(crate) fn within(&self, other: &Patch<'_>) -> Self {
        self.combined(other, |own, other| own & other)
    }

    /// The pixels set here or in `other`, a patch of the same rectangle.
    pub(crate) fn with(&self, other: &Patch<'_>) -> Self {
        self.combined(other, |own, other| own | other)
    }

    fn combined(&self, other: &Patch<'_>, operation: impl Fn(u64, u64) -> u64) -> Self {
        let mut result = self.copy();
        result.combine_with(other, operation);
        result
    }

    /// Combines it with a patch of the same rectangle; what is set in neither must stay so.
    fn combine_with(&mut self, other: &Patch<'_>, operation: impl Fn(u64, u64) -> u64) {
        debug_assert_eq!(self.rect, other.rect, "patches of the same rectangle");
        self.words.iter_mut().zip(&*other.words).for_each(|(own, &other)| *own = operation(*own, other));
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
        fn growing_and_shrinking_are_what_they_say(
            width in 1u32..150, height in 1u32..20, reach in 0i32..14,
            set in prop::collection::vec(prop::bool::weighted(0.2), 3000),
        ) {
            let memory = Memory::new();
            let rect = RectPx { x: 3, y: 4, width, height };
            let patch = Patch::from_fn(&memory, rect, |x, y| set[(y * width as i32 + x) as usize]);
            let near = |x: i32, y: i32| {
                let inside = (0..height as i32).flat_map(|y| (0..width as i32).map(move |x| (x, y)));
                inside.filter(move |&(u, v)| (u - x).abs() <= reach && (v - y).abs() <= reach)
            };
            let grown = Patch::from_fn(&memory, rect, |x, y| near(x, y).any(|(x, y)| patch.get(x, y)));
            let shrunk = Patch::from_fn(&memory, rect, |x, y| near(x, y).all(|(x, y)| patch.get(x, y)));
            prop_assert!(patch.dilated(reach) == grown);
            prop_assert!(patch.eroded(reach) == shrunk);
            prop_assert!(patch.opened(reach) == shrunk.dilated(reach).combined(&patch, |opened, own| opened & own));
        }
    }
}
