//! Exact accounting: what was offered, what is stored, and where the rest went.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Counts of one topic's messages. Once nothing is in flight,
/// `offered = stored + lost_in_queue + lost_on_disk + unrecorded`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TopicAccount {
    /// Offered to the journal.
    pub offered: u64,
    /// In a file, flushed and synced.
    pub stored: u64,
    /// Refused because the queue was full.
    pub lost_in_queue: u64,
    /// Accepted, but the disk failed before they were safe, or recording had failed.
    pub lost_on_disk: u64,
    /// Offered while recording was off, or updates of state that only file heads hold: not meant to be stored.
    pub unrecorded: u64,
    /// Repeated at the heads of files; not counted as stored.
    pub repeated: u64,
}

impl TopicAccount {
    /// Messages that should be in a file and are not.
    pub fn lost(&self) -> u64 {
        self.lost_in_queue + self.lost_on_disk
    }

    fn add(&mut self, other: &TopicAccount) {
        self.offered += other.offered;
        self.stored += other.stored;
        self.lost_in_queue += other.lost_in_queue;
        self.lost_on_disk += other.lost_on_disk;
        self.unrecorded += other.unrecorded;
        self.repeated += other.repeated;
    }
}

/// Accounts by topic.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ledger {
    topics: BTreeMap<String, TopicAccount>,
}

impl Ledger {
    /// The account of `topic`, opened when missing.
    pub(crate) fn topic(&mut self, topic: &str) -> &mut TopicAccount {
        self.topics.entry(topic.to_owned()).or_default()
    }

    pub(crate) fn set_offered(&mut self, offered: &BTreeMap<String, u64>) {
        for (topic, &count) in offered {
            self.topic(topic).offered = count;
        }
    }

    pub(crate) fn add(&mut self, other: &Ledger) {
        for (topic, account) in &other.topics {
            self.topic(topic).add(account);
        }
    }

    /// The accounts as an MCAP metadata record: topic → JSON, with `offered` summed up.
    pub(crate) fn to_metadata(&self) -> BTreeMap<String, String> {
        let entry = |(topic, account): (&String, &TopicAccount)| {
            let offered = account.stored + account.lost() + account.unrecorded;
            (topic.clone(), serde_json::json!(TopicAccount { offered, ..*account }).to_string())
        };
        self.topics.iter().map(entry).collect()
    }

    /// Reads what [`Ledger::to_metadata`] wrote; entries of other writers are skipped.
    pub(crate) fn from_metadata(entries: &BTreeMap<String, String>) -> Self {
        let entry =
            |(topic, json): (&String, &String)| Some((topic.clone(), serde_json::from_str(json).ok()?));
        Self { topics: entries.iter().filter_map(entry).collect() }
    }

    /// Accounts in topic order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &TopicAccount)> {
        self.topics.iter().map(|(topic, account)| (topic.as_str(), account))
    }

    /// One topic's account, if anything was offered on it.
    pub fn get(&self, topic: &str) -> Option<&TopicAccount> {
        self.topics.get(topic)
    }

    /// All topics together.
    pub fn total(&self) -> TopicAccount {
        let mut total = TopicAccount::default();
        self.topics.values().for_each(|account| total.add(account));
        total
    }
}
