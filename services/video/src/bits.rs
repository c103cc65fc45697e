//! Reads the bits of a NAL unit's payload (ITU-T H.264, clauses 7.2 and 9.1).

/// A reader of the raw byte sequence payload behind a NAL unit's header, emulation prevention taken out on the way.
#[derive(Debug)]
pub(crate) struct BitReader<'a> {
    bytes: &'a [u8],
    /// The next byte to be loaded.
    at: usize,
    /// Zero bytes that stand right before `at`.
    zeros: u8,
    current: u8,
    left: u8,
}

impl<'a> BitReader<'a> {
    pub(crate) fn new(payload: &'a [u8]) -> Self {
        Self { bytes: payload, at: 0, zeros: 0, current: 0, left: 0 }
    }

    /// One bit; `None` beyond the end.
    pub(crate) fn bit(&mut self) -> Option<bool> {
        if self.left == 0 {
            self.load()?;
        }
        self.left -= 1;
        Some(self.current >> self.left & 1 == 1)
    }

    /// `u(n)`: up to 32 bits, most significant first.
    pub(crate) fn bits(&mut self, count: u32) -> Option<u32> {
        (0..count).try_fold(0_u32, |value, _| Some(value << 1 | u32::from(self.bit()?)))
    }

    /// `ue(v)`: an unsigned Exp-Golomb number.
    pub(crate) fn unsigned(&mut self) -> Option<u32> {
        let mut zeros = 0;
        while !self.bit()? {
            zeros += 1;
            if zeros > 31 {
                return None;
            }
        }
        let tail = self.bits(zeros)?;
        Some(((1_u64 << zeros) - 1) as u32 + tail)
    }

    /// `se(v)`: a signed Exp-Golomb number.
    pub(crate) fn signed(&mut self) -> Option<i64> {
        let code = i64::from(self.unsigned()?);
        Some(if code % 2 == 0 { -(code / 2) } else { code / 2 + 1 })
    }

    fn load(&mut self) -> Option<()> {
        if self.zeros >= 2 && self.bytes.get(self.at) == Some(&3) {
            self.at += 1;
            self.zeros = 0;
        }
        self.current = *self.bytes.get(self.at)?;
        self.at += 1;
        self.zeros = if self.current == 0 { self.zeros.saturating_add(1) } else { 0 };
        self.left = 8;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_the_standard_codes_them() {
        // 1 | 010 | 011 | 00100 | 00101 and then the end.
        let mut bits = BitReader::new(&[0b1010_0110, 0b0100_0010, 0b1000_0000]);
        assert_eq!([bits.unsigned(), bits.unsigned(), bits.unsigned()], [Some(0), Some(1), Some(2)]);
        assert_eq!([bits.signed(), bits.signed()], [Some(2), Some(-2)]);
        assert_eq!(bits.bits(7), Some(0));
        assert_eq!(bits.bit(), None);
    }

    #[test]
    fn emulation_prevention_is_taken_out() {
        let mut bits = BitReader::new(&[0, 0, 3, 1, 0, 0, 3]);
        assert_eq!(bits.bits(24), Some(1));
        assert_eq!(bits.bits(16), Some(0));
        assert_eq!(bits.bit(), None, "the last 3 belongs to nothing");
    }

    #[test]
    fn a_number_longer_than_any_is_refused() {
        assert_eq!(BitReader::new(&[0, 0, 3, 0, 0, 3, 0, 0]).unsigned(), None);
    }
}
