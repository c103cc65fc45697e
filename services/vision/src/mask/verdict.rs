//! Which windows of one row are still accepted.

use crate::bitmask::BitMask;

use super::boxes::fit;

/// One byte, 1 or 0, for each column at which windows start: those on its first sample, and those on its second.
#[derive(Default)]
pub(super) struct Verdict {
    accepted: [Vec<u8>; 2],
}

impl Verdict {
    #[inline(always)]
    pub(super) fn fit(&mut self, positions: usize) {
        for accepted in &mut self.accepted {
            fit(accepted, positions);
        }
    }

    #[inline(always)]
    pub(super) fn accept_all(&mut self) {
        for accepted in &mut self.accepted {
            accepted.fill(1);
        }
    }

    /// Drops what `passes` refuses; false when nothing is left.
    #[inline(always)]
    pub(super) fn narrow<T: Copy>(&mut self, values: &[Vec<T>; 2], passes: impl Fn(T) -> bool) -> bool {
        let mut left = 0;
        for (accepted, values) in self.accepted.iter_mut().zip(values) {
            for (accepted, &value) in accepted.iter_mut().zip(values) {
                *accepted &= u8::from(passes(value));
                left |= *accepted;
            }
        }
        left != 0
    }

    /// As [`narrow`](Self::narrow), by two values of each window.
    #[inline(always)]
    pub(super) fn narrow_by_two<T: Copy, U: Copy>(
        &mut self,
        values: &[Vec<T>; 2],
        others: &[Vec<U>; 2],
        passes: impl Fn(T, U) -> bool,
    ) {
        for ((accepted, values), others) in self.accepted.iter_mut().zip(values).zip(others) {
            for ((accepted, &value), &other) in accepted.iter_mut().zip(values).zip(others) {
                *accepted &= u8::from(passes(value, other));
            }
        }
    }

    /// Sets the accepted windows in row `y` of `mask`, from word `first_word` on. Windows beyond its right edge do not
    /// lie wholly inside the region and do not count.
    #[inline(always)]
    pub(super) fn store(&self, y: u32, first_word: u32, mask: &mut BitMask) {
        let [on_first, on_second] = &self.accepted;
        let blocks = on_first.chunks_exact(32).zip(on_second.chunks_exact(32));
        for (word, (on_first, on_second)) in (first_word..).zip(blocks) {
            let bits = spread(pack(on_first)) | spread(pack(on_second)) << 1;
            let beyond = (64 * (word + 1)).saturating_sub(mask.width());
            if bits != 0 && beyond < 64 {
                mask.or_word(y, word, bits & u64::MAX >> beyond);
            }
        }
    }
}

/// The lowest bits of 32 bytes, the first byte's lowest.
#[inline(always)]
fn pack(bytes: &[u8]) -> u32 {
    let packed = bytes.chunks_exact(8).map(|eight| {
        let eight = eight.iter().rev().fold(0_u64, |all, &byte| all << 8 | u64::from(byte));
        // Bit 8j of the factor's counterpart lands on bit 56 + j; nothing else reaches those bits.
        (eight.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32
    });
    packed.enumerate().fold(0, |all, (byte, bits)| all | bits << (8 * byte))
}

/// Bit i to bit 2i.
#[inline(always)]
fn spread(bits: u32) -> u64 {
    let mut bits = u64::from(bits);
    bits = (bits | bits << 16) & 0x0000_FFFF_0000_FFFF;
    bits = (bits | bits << 8) & 0x00FF_00FF_00FF_00FF;
    bits = (bits | bits << 4) & 0x0F0F_0F0F_0F0F_0F0F;
    bits = (bits | bits << 2) & 0x3333_3333_3333_3333;
    (bits | bits << 1) & 0x5555_5555_5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn packing_keeps_every_bit(bits: u32) {
            let bytes: Vec<u8> = (0..32).map(|at| (bits >> at & 1) as u8).collect();
            prop_assert_eq!(pack(&bytes), bits);
        }

        #[test]
        fn spreading_doubles_every_place(bits: u32) {
            prop_assert!((0..32).all(|at| spread(bits) >> (2 * at) & 1 == u64::from(bits >> at & 1)));
            prop_assert_eq!(spread(bits).count_ones(), bits.count_ones());
        }
    }
}
