//! Pixels of a patch that something tells from their colours, 64 at a time.

use super::Patch;
use crate::adaptive::word::{WORD_PX, existing};
use crate::frame::Frame;
use crate::mask::{Lanes, Work};

/// Tells which of up to 64 pixels are wanted, the first in bit 0; what it says of pixels that are not there does not matter.
///
/// It is compiled for several sets of vector instructions: every function down to its loops is `inline(always)`.
pub(crate) trait Judge {
    fn wanted(&self, rgb: &[u8]) -> u64;
}

struct Judged<'a, 'm, J> {
    frame: &'a Frame,
    patch: &'a mut Patch<'m>,
    judge: &'a J,
}

impl<J: Judge> Work for Judged<'_, '_, J> {
    #[inline(always)]
    fn run(self) {
        let rect = self.patch.rect;
        let (left, width) = (3 * rect.x as usize, 3 * rect.width as usize);
        let words_per_row = self.patch.words_per_row;
        for y in 0..rect.height as usize {
            let row = &self.frame.row(rect.y + y as u32)[left..left + width];
            for at in 0..words_per_row {
                let bits = &mut self.patch.words[y * words_per_row + at];
                if *bits != 0 {
                    let end = (3 * WORD_PX * (at + 1)).min(width);
                    let rgb = &row[3 * WORD_PX * at..end];
                    *bits &= self.judge.wanted(rgb) & existing(rgb);
                }
            }
        }
    }
}

impl Patch<'_> {
    /// Those of its pixels that `judge` wants.
    pub(crate) fn judged(&self, frame: &Frame, judge: &impl Judge) -> Self {
        let mut patch = self.copy();
        Lanes::default().run(Judged { frame, patch: &mut patch, judge });
        patch
    }
}
