//! The follower's way into its recording: stamps messages and offers them, never waits.

use std::sync::Arc;
use std::time::SystemTime;

use bytes::Bytes;
use recording::{ChannelSpec, Journal, Latch, Message};

/// A message before it is stamped.
pub(crate) struct Entry<'a> {
    /// Where it belongs.
    pub(crate) channel: &'a Arc<ChannelSpec>,
    /// Capture time, ns since the Unix epoch.
    pub(crate) captured_at_ns: i64,
    /// The sender's sequence number.
    pub(crate) sequence: u64,
    /// The encoded message.
    pub(crate) data: Bytes,
    /// Whether later files repeat it.
    pub(crate) latch: Latch,
}

impl Entry<'_> {
    /// The same, stamped with its receipt. Times before 1970 cannot be written and become 0.
    pub(crate) fn stamped(self) -> Message {
        Message {
            channel: Arc::clone(self.channel),
            log_time_ns: now_ns(),
            publish_time_ns: u64::try_from(self.captured_at_ns).unwrap_or(0),
            sequence: self.sequence as u32,
            data: self.data,
            latch: self.latch,
        }
    }
}

/// Offers one message; what the journal cannot keep, it counts.
pub(crate) fn offer(journal: &Journal, entry: Entry<'_>) {
    let _counted_by_the_journal = journal.offer(entry.stamped());
}

/// Now, in ns since the Unix epoch.
pub(crate) fn now_ns() -> u64 {
    let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since_epoch.as_nanos()).unwrap_or(u64::MAX)
}
