//! Memory that begins where a cache line does: no vector that is written there lies across two of them.

use std::ops::{Deref, DerefMut};

/// Bytes of a cache line, and of the widest vectors.
const LINE_BYTES: usize = 64;

/// Numbers from the beginning of a cache line on.
#[derive(Clone, Debug, Default)]
pub(super) struct Aligned<T> {
    memory: Vec<T>,
    start: usize,
    length: usize,
}

impl<T: Copy + Default> Aligned<T> {
    /// Makes it so long; what it holds afterwards is arbitrary.
    #[inline(always)]
    pub(super) fn fit(&mut self, length: usize) {
        let spare = LINE_BYTES / size_of::<T>();
        if self.memory.len() < length + spare {
            self.memory.resize(length + spare, T::default());
        }
        // Where it cannot be told, memory lies as it does: that is only slower.
        self.start = self.memory.as_ptr().align_offset(LINE_BYTES).min(spare);
        self.length = length;
    }
}

impl<T> Deref for Aligned<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        &self.memory[self.start..][..self.length]
    }
}

impl<T> DerefMut for Aligned<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.memory[self.start..][..self.length]
    }
}
