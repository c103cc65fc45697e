//! The last seconds before recording starts.

use std::collections::VecDeque;

use crate::{Message, PreTrigger};

/// Batches kept while recording is off, bounded by time and bytes. Without options it keeps nothing.
#[derive(Debug)]
pub(crate) struct PreTriggerBuffer {
    bounds: Option<PreTrigger>,
    batches: VecDeque<Vec<Message>>,
    bytes: usize,
}

impl PreTriggerBuffer {
    pub(crate) fn new(bounds: Option<PreTrigger>) -> Self {
        Self { bounds, batches: VecDeque::new(), bytes: 0 }
    }

    /// Adds the newest batch and returns those that no longer fit, oldest first.
    pub(crate) fn push(&mut self, batch: Vec<Message>) -> Vec<Vec<Message>> {
        let newest_ns = batch.last().map_or(0, |message| message.log_time_ns);
        self.bytes += batch_bytes(&batch);
        self.batches.push_back(batch);
        let mut evicted = Vec::new();
        while self.overfull(newest_ns) {
            let Some(oldest) = self.batches.pop_front() else { break };
            self.bytes -= batch_bytes(&oldest);
            evicted.push(oldest);
        }
        evicted
    }

    /// Empties the buffer, oldest first.
    pub(crate) fn drain(&mut self) -> VecDeque<Vec<Message>> {
        self.bytes = 0;
        std::mem::take(&mut self.batches)
    }

    fn overfull(&self, newest_ns: u64) -> bool {
        let Some(bounds) = self.bounds else { return !self.batches.is_empty() };
        let oldest_ns = self.batches.front().and_then(|b| b.last()).map_or(newest_ns, |m| m.log_time_ns);
        let span_ns = u128::from(newest_ns.saturating_sub(oldest_ns));
        self.bytes > bounds.max_bytes || span_ns > bounds.duration.as_nanos()
    }
}

fn batch_bytes(batch: &[Message]) -> usize {
    batch.iter().map(Message::queued_bytes).sum()
}
