//! What lies beyond the edge of a picture.

/// What a method reads beyond the edge of a picture. In brackets the name in SciPy's `ndimage`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// The nearest pixel (`nearest`): aaa|abcd|ddd.
    #[default]
    Nearest,
    /// The picture mirrored at the centres of its outermost pixels (`mirror`): dcb|abcd|cba.
    Mirror,
    /// The picture again (`wrap`): bcd|abcd|abc.
    Wrap,
    /// Zeros (`constant`): 000|abcd|000.
    Zero,
}

impl Border {
    /// The pixel that stands at place `at` of a row or column of `length` pixels; `None` where there is a zero.
    #[inline]
    #[must_use]
    pub fn pixel(self, at: i64, length: u32) -> Option<usize> {
        let last = i64::from(length) - 1;
        if (0..=last).contains(&at) {
            return Some(at as usize);
        }
        if length == 0 {
            return None;
        }
        let inside = match self {
            Self::Nearest => at.clamp(0, last),
            Self::Mirror if last == 0 => 0,
            Self::Mirror => last - (at.rem_euclid(2 * last) - last).abs(),
            Self::Wrap => at.rem_euclid(last + 1),
            Self::Zero => return None,
        };
        Some(inside as usize)
    }

    /// The pixels of a row or column that stand under a window of `window` pixels at each place: `window / 2` of them lie
    /// before it. As SciPy's filters have it; so a window of two takes the pixel and the one before it.
    pub(super) fn places(self, length: u32, window: u32) -> Vec<Option<usize>> {
        let before = i64::from(window / 2);
        let total = i64::from(length) + i64::from(window.max(1)) - 1;
        (0..total).map(|at| self.pixel(at - before, length)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_beyond_both_ends() {
        let read = |border: Border, length| -> Vec<Option<usize>> {
            (-4..7).map(|at| border.pixel(at, length)).collect()
        };
        let some = |places: [usize; 11]| places.map(Some).to_vec();
        assert_eq!(read(Border::Nearest, 3), some([0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]));
        assert_eq!(read(Border::Mirror, 3), some([0, 1, 2, 1, 0, 1, 2, 1, 0, 1, 2]));
        assert_eq!(read(Border::Wrap, 3), some([2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]));
        assert_eq!(read(Border::Mirror, 1), some([0; 11]));
        assert_eq!(read(Border::Zero, 2)[3..7], [None, Some(0), Some(1), None]);
        assert_eq!(read(Border::Wrap, 0), [None; 11]);
    }
}
