//! The last seconds before recording starts.

use std::collections::VecDeque;

use crate::{Attachment, LatchKey, Message, PreTrigger};

/// What passes while recording is off. Its order is kept, because a file that begins with it must begin with the state
/// of that time.
#[derive(Debug)]
pub(crate) enum Passing {
    /// Messages that belong together.
    Messages(Vec<Message>),
    /// A file that comes into force.
    Attachment(Attachment),
    /// State that is no longer in force.
    Forgotten(LatchKey),
}

impl Passing {
    fn messages(&self) -> &[Message] {
        match self {
            Passing::Messages(batch) => batch,
            Passing::Attachment(_) | Passing::Forgotten(_) => &[],
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Passing::Messages(batch) => batch.iter().map(Message::queued_bytes).sum(),
            Passing::Attachment(attachment) => attachment.data.len() + size_of::<Passing>(),
            Passing::Forgotten(_) => size_of::<Passing>(),
        }
    }
}

/// What has passed, bounded by time and bytes. Without options it keeps nothing.
#[derive(Debug)]
pub(crate) struct PreTriggerBuffer {
    bounds: Option<PreTrigger>,
    kept: VecDeque<Passing>,
    bytes: usize,
    /// Log time of the newest message, ns.
    newest_ns: u64,
}

impl PreTriggerBuffer {
    pub(crate) fn new(bounds: Option<PreTrigger>) -> Self {
        Self { bounds, kept: VecDeque::new(), bytes: 0, newest_ns: 0 }
    }

    /// Adds the newest and returns what no longer fits, oldest first.
    pub(crate) fn push(&mut self, passing: Passing) -> Vec<Passing> {
        self.newest_ns = passing.messages().last().map_or(self.newest_ns, |message| message.log_time_ns);
        self.bytes += passing.bytes();
        self.kept.push_back(passing);
        let mut evicted = Vec::new();
        while self.overfull() {
            let Some(oldest) = self.kept.pop_front() else { break };
            self.bytes -= oldest.bytes();
            evicted.push(oldest);
        }
        evicted
    }

    /// Log time of the first message, ns.
    pub(crate) fn begins_at_ns(&self) -> Option<u64> {
        self.kept.iter().find_map(|passing| passing.messages().first()).map(|message| message.log_time_ns)
    }

    /// Empties the buffer, oldest first.
    pub(crate) fn drain(&mut self) -> VecDeque<Passing> {
        self.bytes = 0;
        std::mem::take(&mut self.kept)
    }

    fn overfull(&self) -> bool {
        let Some(bounds) = self.bounds else { return !self.kept.is_empty() };
        let Some(oldest) = self.kept.front() else { return false };
        // What comes into force before the first message is in force when the buffer begins.
        let Some(last) = oldest.messages().last() else { return true };
        let span_ns = u128::from(self.newest_ns.saturating_sub(last.log_time_ns));
        self.bytes > bounds.max_bytes || span_ns > bounds.duration.as_nanos()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bytes::Bytes;

    use super::*;
    use crate::{
        Command, JournalOptions,
        testing::{at_ms, channel, latched, message, names, options, read_strictly, recorder, sequences_on},
    };

    #[test]
    fn the_pre_trigger_buffer_goes_first_with_the_state_of_its_time() {
        let directory = tempfile::tempdir().unwrap();
        let pre_trigger = Some(PreTrigger { duration: Duration::from_millis(10), max_bytes: 1 << 20 });
        let mut recorder = recorder(JournalOptions { pre_trigger, ..options(directory.path()) });
        recorder.command(Command::Stop, at_ms(0));
        let (log, landmark) = (channel("/log"), channel("/landmark"));
        let batch = |n: u32| -> Vec<Message> {
            let state = (n.is_multiple_of(8)).then(|| latched(&landmark, n, "red"));
            state.into_iter().chain([message(&log, n, 10)]).collect()
        };
        (0..30).for_each(|n| recorder.store(batch(n), at_ms(u64::from(n))));
        recorder.command(Command::Start, at_ms(30));
        recorder.store(batch(30), at_ms(30));
        recorder.finish(at_ms(31));

        let read = read_strictly(&directory.path().join(names(directory.path()).pop().unwrap()));
        assert_eq!(sequences_on(&read, "/log"), (19..31).collect::<Vec<_>>());
        assert_eq!(sequences_on(&read, "/landmark"), [16, 24], "16 was in force when the buffer begins");
        let account = recorder.ledger().get("/log").copied().unwrap();
        assert_eq!((account.stored, account.unrecorded, account.lost()), (12, 19, 0));
    }

    #[test]
    fn the_pre_trigger_buffer_keeps_what_was_retired_in_it() {
        let directory = tempfile::tempdir().unwrap();
        let pre_trigger = Some(PreTrigger { duration: Duration::from_millis(10), max_bytes: 1 << 20 });
        let mut recorder = recorder(JournalOptions { pre_trigger, ..options(directory.path()) });
        recorder.command(Command::Stop, at_ms(0));
        let (log, landmark) = (channel("/log"), channel("/landmark"));
        let set = |text: &'static str| Attachment {
            name: "landmarks.json".to_owned(),
            media_type: "application/json".to_owned(),
            log_time_ns: 1,
            data: Bytes::from_static(text.as_bytes()),
        };
        recorder.attach(set("red and blue"), at_ms(0));
        recorder.store(vec![latched(&landmark, 0, "red"), latched(&landmark, 1, "blue")], at_ms(0));
        for n in 2..30 {
            if n == 25 {
                recorder.forget(LatchKey("blue".to_owned()));
                recorder.attach(set("red"), at_ms(25));
            }
            recorder.store(vec![message(&log, n, 10)], at_ms(u64::from(n)));
        }
        recorder.command(Command::Start, at_ms(30));
        recorder.command(Command::Split, at_ms(31));
        recorder.finish(at_ms(32));

        // Before it was stopped, the recorder had begun a file.
        let files = names(directory.path()).split_off(1);
        let heads =
            files.iter().map(|name| sequences_on(&read_strictly(&directory.path().join(name)), "/landmark"));
        assert_eq!(
            heads.collect::<Vec<_>>(),
            [vec![1, 0], vec![0]],
            "blue was in force when the buffer began"
        );
        let holds_both = |name: &String| {
            let bytes = std::fs::read(directory.path().join(name)).unwrap();
            bytes.windows(12).any(|window| window == b"red and blue")
        };
        assert_eq!(files.iter().map(holds_both).collect::<Vec<_>>(), [true, false]);
    }
}
