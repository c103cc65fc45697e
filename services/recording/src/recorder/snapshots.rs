//! Which of the many snapshots of a state are worth storing.

use std::collections::BTreeMap;

use crate::{Latch, LatchKey, Message};

/// The longest stretch of a file without a snapshot, ns of log time.
const LONGEST_WITHOUT_NS: u64 = 5_000_000_000;

/// What one file holds so far, as far as snapshots are concerned.
#[derive(Debug, Default)]
pub(super) struct SnapshotSchedule {
    /// Publish time of the first message of each topic, ns.
    first_published_ns: BTreeMap<String, u64>,
    /// Log time of the last snapshot of each state, ns.
    stored_at_ns: BTreeMap<LatchKey, u64>,
}

impl SnapshotSchedule {
    /// Whether `message`, the next in the file's order, is to be stored. All are but some snapshots.
    pub(super) fn wants(&mut self, message: &Message) -> bool {
        let Latch::Snapshot { key, of } = &message.latch else {
            self.note(message);
            return true;
        };
        let first_ns = self.first_published_ns.get(&**of);
        let covered = first_ns.is_some_and(|first_ns| *first_ns <= message.publish_time_ns);
        let recent = self
            .stored_at_ns
            .get(key)
            .is_some_and(|at_ns| message.log_time_ns.saturating_sub(*at_ns) < LONGEST_WITHOUT_NS);
        let wanted = !(covered && recent);
        if wanted {
            self.stored_at_ns.insert(key.clone(), message.log_time_ns);
        }
        wanted
    }

    fn note(&mut self, message: &Message) {
        if !self.first_published_ns.contains_key(&message.channel.topic) {
            self.first_published_ns.insert(message.channel.topic.clone(), message.publish_time_ns);
        }
    }
}
