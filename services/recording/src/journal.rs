//! The journal: one named thread that owns the recorder, fed by a bounded queue.

use std::{
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant, SystemTime},
};

use crate::{
    Attachment, Disk, JournalOptions, LatchKey, Ledger, Message, Now, Offered, Recorder, RecordingError,
    Status, Storage,
    queue::{Item, Queue},
};

/// How stale a published [`Status`] may be while messages flow.
const STATUS_EVERY: Duration = Duration::from_millis(100);

/// What a person can ask of the recorder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Begin a file; the pre-trigger buffer goes first.
    Start,
    /// Finish the file; what follows is not recorded.
    Stop,
    /// Finish the file and go on in a new one.
    Split,
}

/// What the journal leaves behind.
#[derive(Debug, Clone)]
pub struct Report {
    /// Whether the journal finished within its deadline. If not, the file is left to be recovered.
    pub in_time: bool,
    /// Exact accounts by topic.
    pub ledger: Ledger,
    /// The last status; its `file` is the last file.
    pub status: Status,
}

/// A running journal. Offers come from any thread and never wait for the disk.
#[derive(Debug)]
pub struct Journal {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    queue: Queue,
    published: Mutex<Published>,
    ended: Condvar,
}

#[derive(Debug, Default)]
struct Published {
    status: Status,
    ledger: Ledger,
    ended: bool,
}

impl Journal {
    /// Starts the journal thread. A disk that cannot be written is no error here: the journal starts in the
    /// failed state and keeps trying.
    pub fn start(options: JournalOptions) -> Result<Self, RecordingError> {
        let disk = Disk::new(&options.directory);
        Self::start_on(options, disk)
    }

    /// Starts the journal thread on any storage.
    pub fn start_on<S: Storage + 'static>(
        options: JournalOptions,
        storage: S,
    ) -> Result<Self, RecordingError> {
        let queue = Queue::new(options.queue);
        let shared = Arc::new(Shared { queue, published: Mutex::default(), ended: Condvar::new() });
        let (directory, begin) = (options.directory.clone(), options.begin);
        let recorder = Recorder::new(options, storage)?;
        let journal_thread = JournalThread::new(Arc::clone(&shared), recorder);
        thread::Builder::new()
            .name("journal".to_owned())
            .spawn(move || journal_thread.run(begin))
            .map_err(RecordingError::io("cannot start a thread to record into", directory))?;
        Ok(Self { shared })
    }

    /// Offers one message.
    pub fn offer(&self, message: Message) -> Offered {
        self.offer_all(vec![message])
    }

    /// Offers messages that belong together, all or none: no file ends between them.
    pub fn offer_all(&self, batch: Vec<Message>) -> Offered {
        self.shared.queue.offer(batch)
    }

    /// Puts a file into this recording and, until replaced by one of the same name, into every later one.
    pub fn attach(&self, attachment: Attachment) -> Offered {
        self.shared.queue.push(Item::Attach(attachment))
    }

    /// Stops repeating a latched state, e.g. of a retired landmark.
    pub fn forget(&self, key: LatchKey) -> Offered {
        self.shared.queue.push(Item::Forget(key))
    }

    /// Starts, stops or splits, in order with the messages offered before and after.
    pub fn command(&self, command: Command) -> Offered {
        self.shared.queue.push(Item::Command(command))
    }

    /// The recorder's state, at most a tenth of a second old while messages flow.
    pub fn status(&self) -> Status {
        self.shared.published().status.clone()
    }

    /// Accounts by topic, as fresh as [`Journal::status`].
    pub fn ledger(&self) -> Ledger {
        self.shared.published().ledger.clone()
    }

    /// Stops taking offers, stores what is queued, finishes the file, and reports; waits at most `deadline`.
    pub fn finish(&self, deadline: Duration) -> Report {
        self.shared.queue.close();
        let running = |published: &mut Published| !published.ended;
        let waited = self.shared.ended.wait_timeout_while(self.shared.published(), deadline, running);
        let published = waited.unwrap_or_else(PoisonError::into_inner).0;
        Report {
            in_time: published.ended,
            ledger: published.ledger.clone(),
            status: published.status.clone(),
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        self.shared.queue.close();
    }
}

impl Shared {
    fn published(&self) -> MutexGuard<'_, Published> {
        self.published.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

struct JournalThread<S: Storage> {
    shared: Arc<Shared>,
    recorder: Recorder<S>,
    began: Instant,
    published_at: Duration,
    /// Something happened since the status was published.
    news: bool,
}

impl<S: Storage> JournalThread<S> {
    fn new(shared: Arc<Shared>, recorder: Recorder<S>) -> Self {
        Self { shared, recorder, began: Instant::now(), published_at: Duration::ZERO, news: false }
    }

    fn run(mut self, begin: Command) {
        let now = self.now();
        self.recorder.command(begin, now);
        self.publish(now);
        while self.step() {}
        let now = self.now();
        self.recorder.finish(now);
        self.publish(now);
        self.shared.published().ended = true;
        self.shared.ended.notify_all();
    }

    /// Handles the next item or deadline; false at the end.
    fn step(&mut self) -> bool {
        let taken = self.shared.queue.take(self.patience());
        let now = self.now();
        let before = self.recorder.state();
        self.news |= taken.item.is_some();
        self.recorder.note_refused(&taken.refused);
        match taken.item {
            Some(Item::Messages(batch)) => self.recorder.store(batch, now),
            Some(Item::Keep(message)) => self.recorder.keep(&message),
            Some(Item::Attach(attachment)) => self.recorder.attach(attachment, now),
            Some(Item::Forget(key)) => self.recorder.forget(key),
            Some(Item::Command(command)) => self.recorder.command(command, now),
            None => {}
        }
        self.recorder.tick(now);
        if self.recorder.state() != before || (self.news && now.elapsed >= self.published_at + STATUS_EVERY) {
            self.publish(now);
        }
        !taken.ended
    }

    /// How long to wait for the next item: until the recorder or the status is due.
    fn patience(&self) -> Option<Duration> {
        let status_due = self.news.then_some(self.published_at + STATUS_EVERY);
        let due = [self.recorder.next_tick(), status_due].into_iter().flatten().min();
        due.map(|due| due.saturating_sub(self.began.elapsed()))
    }

    fn publish(&mut self, now: Now) {
        (self.published_at, self.news) = (now.elapsed, false);
        let mut ledger = self.recorder.ledger();
        ledger.set_offered(&self.shared.queue.offered());
        let mut status = self.recorder.status();
        status.offered = ledger.total().offered;
        let mut published = self.shared.published();
        (published.status, published.ledger) = (status, ledger);
    }

    fn now(&self) -> Now {
        let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        Now { elapsed: self.began.elapsed(), unix_ns: since_epoch.as_nanos().try_into().unwrap_or(u64::MAX) }
    }
}

#[cfg(test)]
mod tests;
