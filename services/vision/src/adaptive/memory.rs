//! Memory that is taken piece by piece and given back all at once.
//!
//! Two of them serve a search. `'m` names the one that lasts for a landmark's turn in a frame and holds what is kept
//! of it: likenesses, candidates, pursuits. `'s` names the one that lasts for the work on one seed, whose patches and
//! lists are many and large; what comes out of that is copied to the other. Neither holds anything that outlives the
//! frame. What works on a patch takes memory from where the patch lies.

use std::cmp::Ordering;

pub(crate) use bumpalo::Bump as Memory;
pub(crate) use bumpalo::collections::{CollectIn, Vec as List};

/// The elements of a list in an order; those that compare equal stay in theirs.
pub(crate) fn sorted<'m, T>(
    list: List<'m, T>,
    compare: impl Fn(&T, &T) -> Ordering,
) -> impl Iterator<Item = T> {
    let memory = list.bump();
    // The library's stable sort asks for memory of its own.
    let mut numbered: List<'m, (usize, T)> = list.into_iter().enumerate().collect_in(memory);
    numbered.sort_unstable_by(|(at, a), (other, b)| compare(a, b).then(at.cmp(other)));
    numbered.into_iter().map(|(_, element)| element)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_order_is_that_of_a_stable_sort(numbers in prop::collection::vec(0u8..6, 0..60)) {
            let memory = Memory::new();
            let mut slowly: Vec<(usize, u8)> = numbers.into_iter().enumerate().collect();
            let list = slowly.iter().copied().collect_in(&memory);
            let found: Vec<(usize, u8)> = sorted(list, |a, b| a.1.cmp(&b.1)).collect();
            slowly.sort_by_key(|(_, number)| *number);
            prop_assert_eq!(found, slowly);
        }
    }
}
