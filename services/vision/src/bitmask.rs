//! A binary picture, one bit a pixel.

use std::ops::Range;

/// A binary picture: rows of 64-bit words, bit `x % 64` of word `x / 64` is column `x`.
///
/// It remembers which words of each row were written, so that clearing and reading cost what was set, not what could
/// have been: a mask of a landmark is empty almost everywhere. Knows nothing of the doubled grid; its pixels are
/// whatever the caller says they are.
#[derive(Clone, Debug, Default)]
pub struct BitMask {
    width: u32,
    height: u32,
    words_per_row: usize,
    words: Vec<u64>,
    /// For each row the words that may hold set bits.
    touched: Vec<Touched>,
    /// The rows that may hold set bits.
    touched_rows: Touched,
}

/// The words of a row, or the rows, `first..end`; empty when `first >= end`.
#[derive(Clone, Copy, Debug)]
struct Touched {
    first: u32,
    end: u32,
}

impl Default for Touched {
    fn default() -> Self {
        Self::NOTHING
    }
}

impl Touched {
    fn add(&mut self, number: u32) {
        self.first = self.first.min(number);
        self.end = self.end.max(number + 1);
    }

    const NOTHING: Self = Self { first: u32::MAX, end: 0 };
}

/// A maximal horizontal run of set pixels: columns `x_start..x_end` of row `y`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// Row.
    pub y: u32,
    /// First column.
    pub x_start: u32,
    /// The column after the last one.
    pub x_end: u32,
}

impl Run {
    /// Pixels in it.
    #[must_use]
    pub fn length(self) -> u32 {
        self.x_end - self.x_start
    }
}

impl BitMask {
    /// An empty picture of that size.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let mut mask = Self::default();
        mask.reset(width, height);
        mask
    }

    /// Makes this an empty picture of that size, keeping its memory.
    pub fn reset(&mut self, width: u32, height: u32) {
        self.clear();
        let words_per_row = width.div_ceil(64) as usize;
        if (self.width, self.height) != (width, height) {
            (self.width, self.height, self.words_per_row) = (width, height, words_per_row);
            self.words.resize(words_per_row * height as usize, 0);
            self.touched.resize(height as usize, Touched::NOTHING);
        }
    }

    /// Clears every pixel.
    pub fn clear(&mut self) {
        for y in self.touched_rows() {
            let touched = std::mem::take(&mut self.touched[y as usize]);
            if touched.first < touched.end {
                let row = &mut self.words[y as usize * self.words_per_row..][..self.words_per_row];
                row[touched.first as usize..touched.end as usize].fill(0);
            }
        }
        self.touched_rows = Touched::NOTHING;
    }

    /// All rows that hold set pixels, and perhaps some between them that hold none.
    #[must_use]
    pub fn touched_rows(&self) -> Range<u32> {
        let Touched { first, end } = self.touched_rows;
        first.min(end)..end
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether the pixel is set; pixels outside the picture are not.
    #[must_use]
    pub fn get(&self, x: u32, y: u32) -> bool {
        x < self.width
            && y < self.height
            && self.words[y as usize * self.words_per_row + (x / 64) as usize] >> (x % 64) & 1 == 1
    }

    /// As [`get`](Self::get), for neighbours that may lie left of or above the picture.
    #[must_use]
    pub fn get_signed(&self, x: i32, y: i32) -> bool {
        u32::try_from(x).is_ok_and(|x| u32::try_from(y).is_ok_and(|y| self.get(x, y)))
    }

    /// Sets one pixel.
    ///
    /// # Panics
    /// When it lies outside the picture.
    pub fn set(&mut self, x: u32, y: u32) {
        self.or_word(y, x / 64, 1 << (x % 64));
    }

    /// Sets the pixels `x_start..x_end` of row `y`.
    ///
    /// # Panics
    /// When one lies outside the picture.
    pub fn set_run(&mut self, y: u32, x_start: u32, x_end: u32) {
        words_of_run(x_start, x_end).for_each(|(word, bits)| self.or_word(y, word, bits));
    }

    /// Clears the pixels `x_start..x_end` of row `y`.
    pub(crate) fn clear_run(&mut self, y: u32, x_start: u32, x_end: u32) {
        let row = &mut self.words[y as usize * self.words_per_row..][..self.words_per_row];
        words_of_run(x_start, x_end).for_each(|(word, bits)| row[word as usize] &= !bits);
    }

    /// Sets those of the 64 pixels of word `word` (columns from `64 * word`) whose bit is set in `bits`.
    ///
    /// # Panics
    /// When a bit lies outside the picture.
    pub fn or_word(&mut self, y: u32, word: u32, bits: u64) {
        assert!((word as usize) < self.words_per_row, "column {} is outside the picture", 64 * word);
        assert!(
            64 * (word + 1) <= self.width || bits >> (self.width - 64 * word) == 0,
            "bits beyond column {}",
            self.width
        );
        self.words[y as usize * self.words_per_row + word as usize] |= bits;
        self.touched[y as usize].add(word);
        self.touched_rows.add(y);
    }

    /// The words of a row.
    ///
    /// # Panics
    /// When `y` is not below the height.
    #[must_use]
    pub fn row_words(&self, y: u32) -> &[u64] {
        &self.words[y as usize * self.words_per_row..][..self.words_per_row]
    }

    /// Whether a row is known to hold no set pixel.
    pub(crate) fn is_empty_row(&self, y: u32) -> bool {
        self.touched_words(y).1.is_empty()
    }

    /// Number of set pixels.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.touched_rows()
            .flat_map(|y| self.touched_words(y).1)
            .map(|word| u64::from(word.count_ones()))
            .sum()
    }

    /// Appends the runs of row `y`, from the left.
    ///
    /// # Panics
    /// When `y` is not below the height.
    pub fn append_runs(&self, y: u32, runs: &mut Vec<Run>) {
        self.each_run(y, |run| runs.push(run));
    }

    /// Gives each run of row `y`, from the left.
    pub(crate) fn each_run(&self, y: u32, each: impl FnMut(Run)) {
        let (first, words) = self.touched_words(y);
        each_run(y, (first, words), self.width, each);
    }

    /// The number of the first word that may hold set bits, and the words from there that may.
    fn touched_words(&self, y: u32) -> (u32, &[u64]) {
        let Touched { first, end } = self.touched[y as usize];
        if first >= end {
            return (0, &[]);
        }
        (first, &self.row_words(y)[first as usize..end as usize])
    }
}

/// The words that hold the columns `x_start..x_end` of a row, each with the bits of those.
pub(crate) fn words_of_run(x_start: u32, x_end: u32) -> impl Iterator<Item = (u32, u64)> {
    let mut x = x_start;
    std::iter::from_fn(move || {
        (x < x_end).then(|| {
            let stop = (x / 64 * 64 + 64).min(x_end);
            let bits = (u64::MAX >> (64 - (stop - x))) << (x % 64);
            let word = x / 64;
            x = stop;
            (word, bits)
        })
    })
}

/// Gives each run of row `y` of a picture of that width, from the left: of the row's words from number `first` on.
#[inline]
pub(crate) fn each_run(y: u32, (first, words): (u32, &[u64]), width: u32, mut each: impl FnMut(Run)) {
    let mut open: Option<u32> = None;
    for (&word, base) in words.iter().zip((64 * first..).step_by(64)) {
        let mut at = 0;
        while at < 64 {
            let rest = (if open.is_some() { !word } else { word }) >> at;
            if rest == 0 {
                break;
            }
            at += rest.trailing_zeros();
            match open.take() {
                None => open = Some(base + at),
                Some(x_start) => each(Run { y, x_start, x_end: base + at }),
            }
        }
    }
    if let Some(x_start) = open {
        each(Run { y, x_start, x_end: (64 * (first + words.len() as u32)).min(width) });
    }
}

impl PartialEq for BitMask {
    /// Equal size and pixels; what was touched does not matter.
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height, &self.words) == (other.width, other.height, &other.words)
    }
}

impl Eq for BitMask {}

/// The lowest bits of eight bytes that are 0 or 1, the first one's lowest.
#[inline(always)]
pub(crate) fn lowest_bits(eight: [u8; 8]) -> u64 {
    // Bit 8j goes to bit 56 + j; nothing else reaches those bits.
    u64::from_le_bytes(eight).wrapping_mul(0x0102_0408_1020_4080) >> 56
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_are_what_was_set(width in 1u32..200, pieces in prop::collection::vec((0u32..200, 0u32..200), 0..6)) {
            let mut mask = BitMask::new(width, 1);
            let mut plain = vec![false; width as usize];
            for (a, b) in pieces {
                let (start, end) = (a.min(b).min(width), a.max(b).min(width));
                mask.set_run(0, start, end);
                plain[start as usize..end as usize].fill(true);
            }
            let mut runs = Vec::new();
            mask.append_runs(0, &mut runs);
            let mut back = vec![false; width as usize];
            for run in &runs {
                prop_assert!(run.x_start < run.x_end && run.x_end <= width);
                back[run.x_start as usize..run.x_end as usize].fill(true);
            }
            prop_assert!(runs.windows(2).all(|two| two[0].x_end < two[1].x_start));
            prop_assert_eq!(mask.count(), plain.iter().filter(|&&set| set).count() as u64);
            prop_assert!((0..width).all(|x| mask.get(x, 0) == plain[x as usize]));
            prop_assert_eq!(back, plain);
            mask.clear();
            prop_assert_eq!(mask, BitMask::new(width, 1));
        }
    }

    #[test]
    fn reset_keeps_no_pixels_of_the_old_size() {
        let mut mask = BitMask::new(130, 3);
        mask.set_run(1, 5, 130);
        mask.reset(70, 5);
        assert_eq!(mask, BitMask::new(70, 5));
        assert_eq!(mask.count(), 0);
    }
}
