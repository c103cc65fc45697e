//! Counting samples that were sent and never arrived.

use std::collections::VecDeque;

use crate::attachment::{Attachment, Gid};

/// Publishers remembered per stream; one more forgets the one heard longest ago. A stream has one publisher, and a
/// new one after each restart: the bound only keeps a hostile peer from filling memory.
const MAX_PUBLISHERS: usize = 16;

/// How a sample stands to those before it from the same publisher.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The first of this publisher: nothing can be said of what went before.
    First,
    /// The next one.
    InOrder,
    /// The next but `missed`.
    AfterGap {
        /// Samples that did not arrive in between.
        missed: u64,
    },
    /// One that was seen, or counted as missed, before.
    Old,
    /// It carries no attachment.
    Unknown,
}

/// Gaps in one stream, by the sequence numbers of its publishers.
#[derive(Clone, Debug, Default)]
pub struct GapCounter {
    /// Last sequence of each publisher, the most recently heard last.
    last: VecDeque<(Gid, i64)>,
    missed: u64,
    unknown: u64,
}

impl GapCounter {
    /// Takes note of a sample; `None` stands for one without attachment.
    pub fn observe(&mut self, attachment: Option<&Attachment>) -> Arrival {
        let arrival = attachment.map_or(Arrival::Unknown, |attachment| self.place(attachment));
        match arrival {
            Arrival::AfterGap { missed } => self.missed = self.missed.saturating_add(missed),
            Arrival::Unknown => self.unknown += 1,
            Arrival::First | Arrival::InOrder | Arrival::Old => {}
        }
        arrival
    }

    /// Samples that did not arrive, over all publishers; `None` while nothing can be said because no sample carried
    /// an attachment.
    #[must_use]
    pub fn missed(&self) -> Option<u64> {
        (!self.last.is_empty()).then_some(self.missed)
    }

    /// Samples that carried no attachment.
    #[must_use]
    pub fn without_attachment(&self) -> u64 {
        self.unknown
    }

    fn place(&mut self, attachment: &Attachment) -> Arrival {
        let known = self.last.iter().position(|(gid, _)| *gid == attachment.gid);
        let Some((_, last)) = known.and_then(|at| self.last.remove(at)) else {
            if self.last.len() == MAX_PUBLISHERS {
                self.last.pop_front();
            }
            self.last.push_back((attachment.gid, attachment.sequence));
            return Arrival::First;
        };
        self.last.push_back((attachment.gid, last.max(attachment.sequence)));
        match i128::from(attachment.sequence) - i128::from(last) {
            ..=0 => Arrival::Old,
            1 => Arrival::InOrder,
            step => Arrival::AfterGap { missed: u64::try_from(step - 1).unwrap_or(u64::MAX) },
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sample(publisher: u8, sequence: i64) -> Attachment {
        Attachment { sequence, source_time_ns: 0, gid: [publisher; 16] }
    }

    #[test]
    fn gaps_are_counted_for_each_publisher() {
        let mut gaps = GapCounter::default();
        assert_eq!(gaps.observe(Some(&sample(1, 7))), Arrival::First);
        assert_eq!(gaps.observe(Some(&sample(1, 8))), Arrival::InOrder);
        assert_eq!(gaps.observe(Some(&sample(2, 100))), Arrival::First);
        assert_eq!(gaps.observe(Some(&sample(1, 12))), Arrival::AfterGap { missed: 3 });
        assert_eq!(gaps.observe(Some(&sample(1, 9))), Arrival::Old);
        assert_eq!(gaps.observe(Some(&sample(1, 13))), Arrival::InOrder);
        assert_eq!(gaps.missed(), Some(3));
    }

    #[test]
    fn without_attachments_gaps_are_unknown() {
        let mut gaps = GapCounter::default();
        assert_eq!(gaps.observe(None), Arrival::Unknown);
        assert_eq!(gaps.missed(), None);
        assert_eq!(gaps.without_attachment(), 1);
    }

    #[test]
    fn the_extremes_of_the_sequence_do_not_overflow() {
        let mut gaps = GapCounter::default();
        gaps.observe(Some(&sample(1, i64::MIN)));
        assert_eq!(gaps.observe(Some(&sample(1, i64::MAX))), Arrival::AfterGap { missed: u64::MAX - 1 });
        gaps.observe(Some(&sample(2, i64::MIN)));
        gaps.observe(Some(&sample(2, i64::MAX)));
        assert_eq!(gaps.missed(), Some(u64::MAX));
    }

    #[test]
    fn publishers_beyond_the_bound_are_forgotten() {
        let mut gaps = GapCounter::default();
        for publisher in 0..100 {
            gaps.observe(Some(&sample(publisher, 1)));
        }
        assert_eq!(gaps.last.len(), MAX_PUBLISHERS);
        assert_eq!(gaps.observe(Some(&sample(0, 5))), Arrival::First);
        assert_eq!(gaps.observe(Some(&sample(99, 2))), Arrival::InOrder);
    }

    proptest! {
        #[test]
        fn the_count_is_what_was_dropped_between_the_first_and_the_last_received(
            received in prop::collection::vec(any::<bool>(), 1..200),
        ) {
            let mut gaps = GapCounter::default();
            for (sequence, _) in received.iter().enumerate().filter(|(_, received)| **received) {
                gaps.observe(Some(&sample(1, sequence as i64)));
            }
            let first = received.iter().position(|received| *received);
            let last = received.iter().rposition(|received| *received);
            let dropped = first.zip(last).map(|(first, last)| {
                received[first..=last].iter().filter(|received| !**received).count() as u64
            });
            prop_assert_eq!(gaps.missed(), dropped);
        }
    }
}
