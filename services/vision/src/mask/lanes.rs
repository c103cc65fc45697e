//! Which vector instructions the mask is computed with.
//!
//! There is one source for all of them: plain element-by-element loops, compiled once for each instruction set and
//! chosen at run time. So every variant gives the same integers by construction, and the tests compare them bit for
//! bit all the same. On other processors than x86-64 the compiler's baseline is used, on 64-bit ARM that is NEON.
#![allow(unsafe_code, reason = "calling a function compiled for instructions that were detected")]

use crate::adaptive::{Coarse, Likeness, like};

/// Something that may be compiled for any instruction set: every function down to its loops is `inline(always)`.
pub(crate) trait Work {
    /// Whether it gains by vectors of 512 bits. With them compilers gather and scatter numbers of 32 bits from chunk to
    /// chunk, where they should take each chunk as it lies: that takes twice as long.
    const WIDEST: bool = true;

    fn run(self);
}

/// A set of vector instructions that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanes(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Default for Lanes {
    /// The widest.
    fn default() -> Self {
        Self::available().next().unwrap_or(Self(Set::Baseline))
    }
}

impl Lanes {
    /// All that this processor has, the widest first.
    pub fn available() -> impl Iterator<Item = Self> {
        let sets = [
            #[cfg(target_arch = "x86_64")]
            (is_x86_feature_detected!("avx512bw") && is_x86_feature_detected!("avx512vl"), Set::Avx512),
            #[cfg(target_arch = "x86_64")]
            (is_x86_feature_detected!("avx2"), Set::Avx2),
            (true, Set::Baseline),
        ];
        sets.into_iter().filter(|&(present, _)| present).map(|(_, set)| Self(set))
    }

    /// The name in figures and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Set::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "avx512",
        }
    }

    /// Does `work` with these instructions.
    pub(crate) fn run<W: Work>(self, work: W) {
        match self.0 {
            Set::Baseline => work.run(),
            // SAFETY: a `Lanes` of this set exists only where the processor was found to have it.
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 if W::WIDEST => unsafe { run_avx512(work) },
            // SAFETY: as above; and what has the wider ones has these.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 | Set::Avx512 => unsafe { run_avx2(work) },
        }
    }
}

impl Lanes {
    /// [`like::like_bits`] with these instructions.
    pub(crate) fn like_bits(self, row: &[u8], likeness: &Likeness<'_>, bits: &mut [u64]) {
        match self.0 {
            Set::Baseline => like::like_bits(row, likeness, bits),
            // SAFETY: a `Lanes` of this set exists only where the processor was found to have it.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 | Set::Avx512 => unsafe { like_bits_avx2(row, likeness, bits) },
        }
    }

    /// [`like::like_words`] with these instructions.
    pub(crate) fn like_words(self, row: &[u8], coarse: &Coarse, likeness: &Likeness<'_>, bits: &mut [u64]) {
        match self.0 {
            Set::Baseline => like::like_words(row, coarse, likeness, bits),
            // SAFETY: a `Lanes` of this set exists only where the processor was found to have it.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 | Set::Avx512 => unsafe { like_words_avx2(row, coarse, likeness, bits) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn like_bits_avx2(row: &[u8], likeness: &Likeness<'_>, bits: &mut [u64]) {
    like::like_bits(row, likeness, bits);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn like_words_avx2(row: &[u8], coarse: &Coarse, likeness: &Likeness<'_>, bits: &mut [u64]) {
    like::like_words(row, coarse, likeness, bits);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn run_avx2(work: impl Work) {
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512vl,avx512dq,bmi1,bmi2")]
fn run_avx512(work: impl Work) {
    work.run();
}
