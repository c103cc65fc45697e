//! How wide the numbers of the exact test must be.

/// A number that sums are kept in. Arithmetic wraps; whoever chooses the width sees to it that results fit.
pub(super) trait Lane: Copy + Default {
    /// The lowest bits of `value`.
    fn from_i64(value: i64) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// All bits set where `self <= most`, else none.
    fn at_most(self, most: Self) -> Self;
    fn and(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;
    /// The lowest bit.
    fn lowest(self) -> u8;
}

macro_rules! lane {
    ($number:ty) => {
        impl Lane for $number {
            #[inline(always)]
            fn from_i64(value: i64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self.wrapping_add(other)
            }
            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                self.wrapping_sub(other)
            }
            #[inline(always)]
            fn times(self, other: Self) -> Self {
                self.wrapping_mul(other)
            }
            #[inline(always)]
            fn at_most(self, most: Self) -> Self {
                if self <= most { -1 } else { 0 }
            }
            #[inline(always)]
            fn and(self, other: Self) -> Self {
                self & other
            }
            #[inline(always)]
            fn or(self, other: Self) -> Self {
                self | other
            }
            #[inline(always)]
            fn lowest(self) -> u8 {
                self as u8 & 1
            }
        }
    };
}

lane!(i16);
lane!(i32);
lane!(i64);

/// `low..=low + reach` of unsigned numbers, made ready for one signed comparison: every instruction set has that one.
#[derive(Clone, Copy)]
pub(super) struct Within<T> {
    offset: T,
    most: T,
}

impl<T: Lane> Within<T> {
    /// The numbers from `low` to `high`, kept in `bits` bits.
    #[inline(always)]
    pub(super) fn new(low: i64, high: i64, bits: u32) -> Self {
        let half = (1_i64 << (bits - 1)).wrapping_neg();
        Self {
            offset: T::from_i64(low.wrapping_sub(half)),
            most: T::from_i64(high.wrapping_sub(low).wrapping_add(half)),
        }
    }

    /// All bits set where it holds `value`.
    #[inline(always)]
    pub(super) fn holds(self, value: T) -> T {
        value.minus(self.offset).at_most(self.most)
    }
}

/// The level that counts as 0: the spread does not change when all levels are shifted, and sums stay small around it.
pub(super) const MIDDLE_LEVEL: i64 = 128;

/// The narrowest numbers that hold the sums of a window of n samples x, levels counted from [`MIDDLE_LEVEL`]: the
/// narrower, the more of them per instruction.
pub(super) trait Precision {
    /// For S = Σx, which must fit.
    type Sum: Lane;
    /// For nQ = nΣx² and D = nQ − S². D must fit, unsigned; nQ and S² may wrap, their difference comes out right.
    type Spread: Lane;

    /// S².
    fn square(sum: Self::Sum) -> Self::Spread;

    /// Whether a sum or spread lies between bounds.
    #[inline(always)]
    fn sums(low: i64, high: i64) -> Within<Self::Sum> {
        Within::new(low, high, 8 * size_of::<Self::Sum>() as u32)
    }

    /// As [`sums`](Self::sums).
    #[inline(always)]
    fn spreads(low: i64, high: i64) -> Within<Self::Spread> {
        Within::new(low, high, 8 * size_of::<Self::Spread>() as u32)
    }
}

/// For n ≤ 256: |S| ≤ 128 · 256 = 2¹⁵, and never 2¹⁵ itself with its sign.
pub(super) struct Narrow;

impl Precision for Narrow {
    type Sum = i16;
    type Spread = i32;

    #[inline(always)]
    fn square(sum: i16) -> i32 {
        i32::from(sum) * i32::from(sum)
    }
}

/// For n ≤ 514: D ≤ (127.5 · 514)² < 2³².
pub(super) struct Medium;

impl Precision for Medium {
    type Sum = i32;
    type Spread = i32;

    #[inline(always)]
    fn square(sum: i32) -> i32 {
        sum.wrapping_mul(sum)
    }
}

/// For every window.
pub(super) struct Wide;

impl Precision for Wide {
    type Sum = i32;
    type Spread = i64;

    #[inline(always)]
    fn square(sum: i32) -> i64 {
        i64::from(sum) * i64::from(sum)
    }
}

/// The largest windows, in samples, that [`Narrow`] and [`Medium`] hold.
pub(super) const NARROW_SAMPLES: u32 = 256;
pub(super) const MEDIUM_SAMPLES: u32 = 514;
