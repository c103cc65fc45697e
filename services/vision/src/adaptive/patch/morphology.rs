//! Growing and shrinking a patch, 64 pixels at a time.

use super::Patch;

impl Patch {
    /// Grown by `reach` pixels in all eight directions.
    pub(crate) fn dilated(&self, reach: i32) -> Self {
        let mut grown = self.clone();
        let mut done = 0;
        while done < reach {
            // What has grown by `done` covers gaps of twice that, so the next step may be that much larger.
            let step = (reach - done).min(2 * done + 1).min(63);
            grown = grown.spread(step);
            done += step;
        }
        grown
    }

    /// With every pixel also set `step` columns to both sides, and then all those `step` rows up and down.
    fn spread(&self, step: i32) -> Self {
        let mut across = Self::empty(self.rect);
        let words = self.rect.width.div_ceil(64) as i32;
        for y in 0..self.height() {
            for word in 0..words {
                let left = 64 * word;
                let bits =
                    self.bits_from(left, y) | self.bits_from(left - step, y) | self.bits_from(left + step, y);
                across.or_bits(y as u32, word as u32, bits & self.columns_of(word));
            }
        }
        let mut grown = Self::empty(self.rect);
        for y in 0..self.height() {
            for word in 0..words {
                let bits = |y| across.bits_from(64 * word, y);
                grown.or_bits(y as u32, word as u32, bits(y) | bits(y - step) | bits(y + step));
            }
        }
        grown
    }

    /// The bits of a word that are columns of the patch.
    fn columns_of(&self, word: i32) -> u64 {
        let columns = self.width() - 64 * word;
        if columns >= 64 { u64::MAX } else { (1 << columns) - 1 }
    }

    /// Shrunk by `reach` pixels in all eight directions. The patch's own border does not shrink it, so that an object
    /// cut by the picture's edge keeps its core.
    pub(crate) fn eroded(&self, reach: i32) -> Self {
        self.inverted().dilated(reach).inverted()
    }

    /// Eroded and dilated again: thin attachments are gone.
    pub(crate) fn opened(&self, reach: i32) -> Self {
        self.eroded(reach).dilated(reach).combined(self, |opened, own| opened & own)
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
