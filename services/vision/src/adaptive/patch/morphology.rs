//! Growing and shrinking a patch, 64 pixels at a time.

use super::Patch;

impl Patch {
    /// Grown by `reach` pixels in all eight directions.
    pub(crate) fn dilated(&self, reach: i32) -> Self {
        let mut grown = self.clone();
        grown.grow(reach, &mut Self::empty(self.rect));
        grown
    }

    /// Grows as [`dilated`](Self::dilated) says; `memory` is a patch of the same rectangle.
    fn grow(&mut self, reach: i32, memory: &mut Self) {
        let mut done = 0;
        while done < reach {
            // What has grown by `done` covers gaps of twice that, so the next step may be that much larger.
            let step = (reach - done).min(2 * done + 1).min(63);
            self.spread(step, memory);
            done += step;
        }
    }

    /// Sets the pixels `step` columns to both sides of every set one, and then of all these `step` rows up and down.
    fn spread(&mut self, step: i32, across: &mut Self) {
        across.mask.clear();
        let words = self.rect.width.div_ceil(64) as i32;
        for y in 0..self.height() {
            for word in 0..words {
                let left = 64 * word;
                let bits =
                    self.bits_from(left, y) | self.bits_from(left - step, y) | self.bits_from(left + step, y);
                across.or_bits(y as u32, word as u32, bits & self.columns_of(word));
            }
        }
        for y in 0..self.height() {
            for word in 0..words {
                let bits = |y| across.bits_from(64 * word, y);
                self.or_bits(y as u32, word as u32, bits(y - step) | bits(y) | bits(y + step));
            }
        }
    }

    /// The bits of a word that are columns of the patch.
    fn columns_of(&self, word: i32) -> u64 {
        let columns = self.width() - 64 * word;
        if columns >= 64 { u64::MAX } else { (1 << columns) - 1 }
    }

    /// Shrunk by `reach` pixels in all eight directions. The patch's own border does not shrink it, so that an object
    /// cut by the picture's edge keeps its core.
    pub(crate) fn eroded(&self, reach: i32) -> Self {
        let (mut shrunk, mut memory) = (self.inverted(), Self::empty(self.rect));
        shrunk.grow(reach, &mut memory);
        shrunk.invert(&mut memory);
        shrunk
    }

    /// Eroded and dilated again: thin attachments are gone.
    pub(crate) fn opened(&self, reach: i32) -> Self {
        let (mut opened, mut memory) = (self.inverted(), Self::empty(self.rect));
        opened.grow(reach, &mut memory);
        opened.invert(&mut memory);
        opened.grow(reach, &mut memory);
        opened.combined(self, |opened, own| opened & own)
    }

    /// Sets what is not set, and the other way round; `memory` is a patch of the same rectangle.
    fn invert(&mut self, memory: &mut Self) {
        memory.mask.clear();
        for y in 0..self.rect.height {
            for (word, &bits) in self.mask.row_words(y).iter().enumerate() {
                memory.or_bits(y, word as u32, !bits & self.columns_of(word as i32));
            }
        }
        std::mem::swap(&mut self.mask, &mut memory.mask);
    }

    /// The pixels of the rectangle that are not set.
    pub(crate) fn inverted(&self) -> Self {
        self.combined(self, |own, _| !own)
    }

    /// The pixels set here and not in `other`, a patch of the same rectangle.
    pub(crate) fn without(&self, other: &Self) -> Self {
        self.combined(other, |own, other| own & !other)
    }

    /// The pixels set here or in `other`, a patch of the same rectangle.
    pub(crate) fn with(&self, other: &Self) -> Self {
        self.combined(other, |own, other| own | other)
    }

    fn combined(&self, other: &Self, operation: impl Fn(u64, u64) -> u64) -> Self {
        let mut result = Self::empty(self.rect);
        for y in 0..self.rect.height {
            let rows = self.mask.row_words(y).iter().zip(other.mask.row_words(y));
            for (word, (&own, &other)) in rows.enumerate() {
                let bits = operation(own, other) & self.columns_of(word as i32);
                result.or_bits(y, word as u32, bits);
            }
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RectPx;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn growing_and_shrinking_are_what_they_say(
            width in 1u32..80, height in 1u32..20, set in prop::collection::vec(prop::bool::weighted(0.2), 1600), reach in 0i32..4,
        ) {
            let rect = RectPx { x: 3, y: 4, width, height };
            let patch = Patch::from_fn(rect, |x, y| set[(y * width as i32 + x) as usize]);
            let near = |x: i32, y: i32| {
                let inside = (0..height as i32).flat_map(|y| (0..width as i32).map(move |x| (x, y)));
                inside.filter(move |&(u, v)| (u - x).abs() <= reach && (v - y).abs() <= reach)
            };
            let grown = Patch::from_fn(rect, |x, y| near(x, y).any(|(x, y)| patch.get(x, y)));
            let shrunk = Patch::from_fn(rect, |x, y| near(x, y).all(|(x, y)| patch.get(x, y)));
            prop_assert!(patch.dilated(reach) == grown);
            prop_assert!(patch.eroded(reach) == shrunk);
            prop_assert!(patch.opened(reach) == shrunk.dilated(reach).combined(&patch, |opened, own| opened & own));
        }
    }
}
