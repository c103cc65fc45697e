//! The recorder as a state machine: messages, commands and time go in; files come out.
//!
//! It runs on the journal thread, and in tests without any thread or clock. Its states are off, recording
//! and failed; a failed recorder counts what it cannot store and tries a new file every second.

use std::time::Duration;

use crate::{
    Attachment, Command, FileName, FileWriter, JournalOptions, Latch, LatchKey, Ledger, Message,
    RecordingError, Rotation, State, Status, Storage,
    file_name::is_vehicle,
    latched::Latched,
    pre_trigger::{Passing, PreTriggerBuffer},
    writer::Purpose,
};
use seam::Seam;
use snapshots::SnapshotSchedule;

mod files;
mod seam;
mod snapshots;
#[cfg(test)]
mod tests;

/// How long a failed recorder waits before it tries again.
const RETRY_EVERY: Duration = Duration::from_secs(1);

/// The two clocks, read once per step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Now {
    /// Monotonic, since any fixed moment.
    pub elapsed: Duration,
    /// Wall clock, nanoseconds since the Unix epoch; names files and stamps heads, decides nothing.
    pub unix_ns: u64,
}

/// Stores messages in rotating files of a [`Storage`].
pub struct Recorder<S: Storage> {
    options: JournalOptions,
    storage: S,
    phase: Phase<S::File>,
    latched: Latched,
    pre_trigger: PreTriggerBuffer,
    /// Everything that is settled: closed files and losses.
    settled: Ledger,
    /// Losses since the last accounts record, to be told in the next one.
    untold: Ledger,
    last_file: Option<(String, u64)>,
    files_finished: u64,
    free_bytes: Option<u64>,
}

enum Phase<F: crate::RecordingFile> {
    Off,
    Recording(Box<OpenFile<F>>),
    Failed { reason: String, retry_at: Duration },
}

struct OpenFile<F: crate::RecordingFile> {
    writer: FileWriter<F>,
    name: FileName,
    opened_at: Duration,
    /// When the oldest unsynced message must be safe.
    sync_due: Option<Duration>,
    /// What decides whether a snapshot is stored.
    snapshots: SnapshotSchedule,
    /// What decides where the next file begins.
    seam: Seam,
}

impl<S: Storage> Recorder<S> {
    /// A recorder that is off; `options.begin` is the caller's to apply.
    pub fn new(options: JournalOptions, storage: S) -> Result<Self, RecordingError> {
        if !is_vehicle(&options.vehicle) {
            return Err(RecordingError::BadVehicle(options.vehicle));
        }
        Ok(Self {
            pre_trigger: PreTriggerBuffer::new(options.pre_trigger),
            options,
            storage,
            phase: Phase::Off,
            latched: Latched::default(),
            settled: Ledger::default(),
            untold: Ledger::default(),
            last_file: None,
            files_finished: 0,
            free_bytes: None,
        })
    }

    /// Starts, stops or splits; where a stream is recorded, the split waits for its next keyframe. Start and split make a failed recorder try again at once.
    pub fn command(&mut self, command: Command, now: Now) {
        match (command, &mut self.phase) {
            (Command::Start, Phase::Recording(_)) | (Command::Split | Command::Stop, Phase::Off) => {}
            (Command::Start, Phase::Off) => self.start(now),
            (Command::Start | Command::Split, Phase::Failed { .. }) => self.reopen(now.unix_ns, now),
            (Command::Split, Phase::Recording(file)) if !file.seam.is_anywhere() => {
                file.seam.ask(now.elapsed)
            }
            (Command::Split, Phase::Recording(_)) => {
                self.close(now);
                self.reopen(now.unix_ns, now);
            }
            (Command::Stop, _) => {
                self.close(now);
                self.phase = Phase::Off;
            }
        }
    }

    /// Takes messages that belong together: no new file begins between them.
    pub fn store(&mut self, batch: Vec<Message>, now: Now) {
        let Some(first_log_time_ns) = batch.first().map(|message| message.log_time_ns) else { return };
        match &mut self.phase {
            Phase::Off => return self.let_pass(Passing::Messages(batch)),
            Phase::Recording(file) => {
                if file.is_full(&self.options.rotation, now) {
                    file.seam.ask(now.elapsed);
                }
                if file.seam.is_before(&batch, now.elapsed) {
                    self.close(now);
                    self.reopen(first_log_time_ns, now);
                }
            }
            Phase::Failed { retry_at, .. } if now.elapsed >= *retry_at => self.reopen(first_log_time_ns, now),
            Phase::Failed { .. } => {}
        }
        for message in batch {
            self.store_one(&message, now);
        }
    }

    /// Keeps `attachment` for the heads of later files and writes it into the open one.
    pub fn attach(&mut self, attachment: Attachment, now: Now) {
        match &mut self.phase {
            Phase::Off => return self.let_pass(Passing::Attachment(attachment)),
            Phase::Failed { .. } => {}
            Phase::Recording(file) => {
                if let Err(error) = file.writer.attach(&attachment) {
                    self.fail(&error, now);
                }
            }
        }
        self.latched.keep_attachment(attachment);
    }

    /// Stops repeating the state `key`.
    pub fn forget(&mut self, key: LatchKey) {
        match self.phase {
            Phase::Off => self.let_pass(Passing::Forgotten(key)),
            Phase::Recording(_) | Phase::Failed { .. } => self.latched.forget(&key),
        }
    }

    /// Counts messages that never reached the recorder.
    pub fn note_refused(&mut self, refused: &Ledger) {
        self.settled.add(refused);
        self.untold.add(refused);
    }

    /// Keeps the state in `message` for later heads without storing the message.
    pub fn keep(&mut self, message: &Message) {
        self.latched.keep(message);
    }

    /// Syncs when due, watches free space, retries when failed.
    pub fn tick(&mut self, now: Now) {
        match &mut self.phase {
            Phase::Recording(file) if file.sync_due.is_some_and(|due| now.elapsed >= due) => {
                file.sync_due = None;
                if let Err(error) = file.writer.sync() {
                    self.fail(&error, now);
                } else if let Err(error) = self.ensure_room(0) {
                    self.close(now);
                    self.fail(&error, now);
                }
            }
            Phase::Failed { retry_at, .. } if now.elapsed >= *retry_at => self.reopen(now.unix_ns, now),
            _ => {}
        }
    }

    /// When [`Recorder::tick`] has something to do next.
    pub fn next_tick(&self) -> Option<Duration> {
        match &self.phase {
            Phase::Off => None,
            Phase::Recording(file) => file.sync_due,
            Phase::Failed { retry_at, .. } => Some(*retry_at),
        }
    }

    /// Closes the open file. What was offered by now is settled afterwards.
    pub fn finish(&mut self, now: Now) {
        self.close(now);
        for passing in self.pre_trigger.drain() {
            self.pass_by(passing);
        }
    }

    /// Accounts so far: everything settled and what the open file holds for certain.
    pub fn ledger(&self) -> Ledger {
        let mut ledger = self.settled.clone();
        if let Phase::Recording(file) = &self.phase {
            ledger.add(file.writer.stored());
        }
        ledger
    }

    /// Off, recording or failed.
    pub fn state(&self) -> State {
        match self.phase {
            Phase::Off => State::Off,
            Phase::Recording(_) => State::Recording,
            Phase::Failed { .. } => State::Failed,
        }
    }

    /// A snapshot for people. `offered` is left to the queue, which knows it.
    pub fn status(&self) -> Status {
        let total = self.ledger().total();
        let reason = match &self.phase {
            Phase::Failed { reason, .. } => Some(reason.clone()),
            Phase::Off | Phase::Recording(_) => None,
        };
        let open = match &self.phase {
            Phase::Recording(file) => Some((file.name.active(), file.writer.bytes())),
            _ => self.last_file.clone(),
        };
        Status {
            state: self.state(),
            reason,
            bytes: open.as_ref().map_or(0, |(_, bytes)| *bytes),
            file: open.map(|(name, _)| self.storage.path(&name)),
            offered: 0,
            stored: total.stored,
            lost: total.lost(),
            free_bytes: self.free_bytes,
            files_finished: self.files_finished,
        }
    }

    fn start(&mut self, now: Now) {
        let first_log_time_ns = self.pre_trigger.begins_at_ns().unwrap_or(now.unix_ns);
        let kept = self.pre_trigger.drain();
        self.reopen(first_log_time_ns, now);
        for passing in kept {
            match passing {
                Passing::Messages(batch) => batch.iter().for_each(|message| self.store_one(message, now)),
                Passing::Attachment(attachment) => self.attach(attachment, now),
                Passing::Forgotten(key) => self.forget(key),
            }
        }
    }

    fn store_one(&mut self, message: &Message, now: Now) {
        self.latched.keep(message);
        let Phase::Recording(file) = &mut self.phase else {
            self.count_unstored(message);
            return;
        };
        if !file.snapshots.wants(message) {
            self.settled.topic(&message.channel.topic).unrecorded += 1;
            return;
        }
        file.sync_due.get_or_insert(now.elapsed + self.options.writer.flush_every);
        file.seam.note(message);
        if let Err(error) = file.writer.write(message, message.log_time_ns, Purpose::Event) {
            self.fail(&error, now);
        }
    }

    /// A message that a failed recorder cannot store; a snapshot is not lost, a later head will hold it.
    fn count_unstored(&mut self, message: &Message) {
        let topic = &message.channel.topic;
        if let Latch::Snapshot { .. } = message.latch {
            self.settled.topic(topic).unrecorded += 1;
        } else {
            self.settled.topic(topic).lost_on_disk += 1;
            self.untold.topic(topic).lost_on_disk += 1;
        }
    }

    /// Takes what comes while recording is off.
    fn let_pass(&mut self, passing: Passing) {
        for evicted in self.pre_trigger.push(passing) {
            self.pass_by(evicted);
        }
    }

    /// What will not be recorded, but for the state it leaves.
    fn pass_by(&mut self, passing: Passing) {
        match passing {
            Passing::Messages(batch) => {
                for message in &batch {
                    self.latched.keep(message);
                    self.settled.topic(&message.channel.topic).unrecorded += 1;
                }
            }
            Passing::Attachment(attachment) => self.latched.keep_attachment(attachment),
            Passing::Forgotten(key) => self.latched.forget(&key),
        }
    }
}

impl<F: crate::RecordingFile> OpenFile<F> {
    fn is_full(&self, rotation: &Rotation, now: Now) -> bool {
        self.writer.bytes() >= rotation.max_bytes
            || now.elapsed.saturating_sub(self.opened_at) >= rotation.max_duration
    }
}
