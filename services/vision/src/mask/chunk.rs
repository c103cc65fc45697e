//! Thirty-two neighbouring columns at a time.
//!
//! Fixed-size arrays by value and plain loops over them: whatever vector width the enclosing function is compiled for,
//! each loop becomes a few whole instructions, without a remainder even in the narrowest area.

use super::lane::Lane;
use crate::bitmask::lowest_bits;

/// Columns in a chunk.
pub(super) const WIDTH: usize = 32;

/// A value for each of 32 neighbouring columns.
pub(super) type Chunk<T> = [T; WIDTH];

/// A row as chunks, for a loop that needs no bounds checks. Rows are whole chunks long.
#[inline(always)]
pub(super) fn chunks<T>(row: &[T]) -> &[Chunk<T>] {
    row.as_chunks().0
}

/// As [`chunks`], to be written.
#[inline(always)]
pub(super) fn chunks_mut<T>(row: &mut [T]) -> &mut [Chunk<T>] {
    row.as_chunks_mut().0
}

/// `with` of every column of both.
#[inline(always)]
pub(super) fn join<T: Copy, U: Copy, V: Copy + Default>(
    left: Chunk<T>,
    right: Chunk<U>,
    with: impl Fn(T, U) -> V,
) -> Chunk<V> {
    let mut joined = [V::default(); WIDTH];
    for at in 0..WIDTH {
        joined[at] = with(left[at], right[at]);
    }
    joined
}

/// The sum of every column of both.
#[inline(always)]
pub(super) fn add<T: Lane>(left: Chunk<T>, right: Chunk<T>) -> Chunk<T> {
    join(left, right, T::plus)
}

/// Whether any column's lowest bit is set.
#[inline(always)]
pub(super) fn any<T: Lane>(chunk: &Chunk<T>) -> bool {
    let mut any = T::default();
    for value in chunk {
        any = any.or(*value);
    }
    any.lowest() != 0
}

/// The lowest bits of all columns, the first column's lowest.
#[inline(always)]
pub(super) fn pack<T: Lane>(chunk: Chunk<T>) -> u32 {
    // Not `map`: it would be compiled without the vector instructions of its caller.
    let mut lowest = [0; WIDTH];
    for at in 0..WIDTH {
        lowest[at] = chunk[at].lowest();
    }
    let mut packed = 0;
    for (at, eight) in lowest.as_chunks::<8>().0.iter().enumerate() {
        packed |= (lowest_bits(*eight) as u32) << (8 * at);
    }
    packed
}

/// The smallest multiple of [`WIDTH`] that is not below `columns`.
pub(super) fn whole_chunks(columns: usize) -> usize {
    columns.next_multiple_of(WIDTH)
}

/// Makes `buffer` at least that long; what it holds afterwards is arbitrary.
#[inline(always)]
pub(super) fn fit<T: Copy + Default>(buffer: &mut Vec<T>, length: usize) {
    if buffer.len() < length {
        buffer.resize(length, T::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn packing_keeps_every_bit(bits: u32) {
            let chunk: Chunk<i16> = std::array::from_fn(|at| (bits >> at & 1) as i16);
            prop_assert_eq!(pack(chunk), bits);
        }
    }
}
