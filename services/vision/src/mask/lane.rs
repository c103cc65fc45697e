//! How wide the numbers of the exact test must be.

/// A number that sums are kept in. Arithmetic wraps; whoever chooses the width sees to it that results fit.
pub(super) trait Lane: Copy + Default {
    fn from_level(level: u8) -> Self;
    fn from_u32(value: u32) -> Self;
    fn from_u64(value: u64) -> Self;
    fn to_u64(self) -> u64;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// Whether `low <= self <= low + reach`, by one unsigned comparison.
    fn within(self, low: Self, reach: Self) -> bool;
}

macro_rules! lane {
    ($number:ty) => {
        impl Lane for $number {
            #[inline(always)]
            fn from_level(level: u8) -> Self {
                Self::from(level)
            }
            #[inline(always)]
            fn from_u32(value: u32) -> Self {
                value as Self
            }
            #[inline(always)]
            fn from_u64(value: u64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn to_u64(self) -> u64 {
                u64::from(self)
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
            fn within(self, low: Self, reach: Self) -> bool {
                self.wrapping_sub(low) <= reach
            }
        }
    };
}

lane!(u8);
lane!(u16);
lane!(u32);
lane!(u64);

/// The narrowest numbers that hold the sums of a window of n samples: the narrower, the more of them per instruction.
pub(super) trait Precision {
    /// For S = Σx.
    type Sum: Lane;
    /// For Q = Σx² and D = nQ − S². Q and D must fit; nQ and S² may wrap, their difference comes out right.
    type Spread: Lane;
}

/// For n ≤ 257: S ≤ 255 · 257 = 2¹⁶ − 1.
pub(super) struct Narrow;

impl Precision for Narrow {
    type Sum = u16;
    type Spread = u32;
}

/// For n ≤ 514: D ≤ (127.5 · 514)² < 2³².
pub(super) struct Medium;

impl Precision for Medium {
    type Sum = u32;
    type Spread = u32;
}

/// For every window.
pub(super) struct Wide;

impl Precision for Wide {
    type Sum = u32;
    type Spread = u64;
}

/// The largest windows, in samples, that [`Narrow`] and [`Medium`] hold.
pub(super) const NARROW_SAMPLES: u32 = 257;
pub(super) const MEDIUM_SAMPLES: u32 = 514;
