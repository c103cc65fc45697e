//! The bounded queue between the threads that offer and the journal thread.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use crate::{Attachment, Command, LatchKey, Ledger, Message, QueueBounds};

/// What became of an offer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offered {
    /// Queued.
    Accepted,
    /// The queue is full; counted as lost.
    Refused,
    /// The journal has finished; counted as lost.
    Closed,
}

/// What travels to the journal thread, in order.
#[derive(Debug)]
pub(crate) enum Item {
    Messages(Vec<Message>),
    /// State whose message was refused: not stored, but later heads must hold it.
    Keep(Message),
    Attach(Attachment),
    Forget(LatchKey),
    Command(Command),
}

/// The next item and what happened since the last.
#[derive(Debug, Default)]
pub(crate) struct Taken {
    /// Missing when time ran out or the queue is closed and empty.
    pub(crate) item: Option<Item>,
    /// Messages refused since, by topic.
    pub(crate) refused: Ledger,
    /// Closed and empty: no more will come.
    pub(crate) ended: bool,
}

/// A queue that refuses rather than blocks.
#[derive(Debug)]
pub(crate) struct Queue {
    bounds: QueueBounds,
    inner: Mutex<Inner>,
    arrived: Condvar,
}

#[derive(Debug, Default)]
struct Inner {
    items: VecDeque<Item>,
    messages: usize,
    bytes: usize,
    offered: BTreeMap<String, u64>,
    refused: Ledger,
    closed: bool,
}

impl Queue {
    pub(crate) fn new(bounds: QueueBounds) -> Self {
        Self { bounds, inner: Mutex::default(), arrived: Condvar::new() }
    }

    /// Queues all of `batch` or nothing. Never waits for the disk.
    pub(crate) fn offer(&self, batch: Vec<Message>) -> Offered {
        let bytes: usize = batch.iter().map(Message::queued_bytes).sum();
        let bulky = batch.iter().any(|message| message.data.len() > QueueBounds::BULK_BYTES);
        let limit_bytes = if bulky { self.bounds.bulk_limit_bytes() } else { self.bounds.bytes };
        let mut inner = self.lock();
        for message in &batch {
            // Only a topic's first message copies the key.
            match inner.offered.get_mut(&message.channel.topic) {
                Some(offered) => *offered += 1,
                None => drop(inner.offered.insert(message.channel.topic.clone(), 1)),
            }
        }
        let fits = inner.messages + batch.len() <= self.bounds.messages && inner.bytes + bytes <= limit_bytes;
        if inner.closed || !fits {
            inner.refuse(batch, &self.bounds);
            return if inner.closed { Offered::Closed } else { Offered::Refused };
        }
        inner.messages += batch.len();
        inner.bytes += bytes;
        inner.items.push_back(Item::Messages(batch));
        drop(inner);
        self.arrived.notify_one();
        Offered::Accepted
    }

    /// Queues something other than messages. These are few: the callers are people and landmark sets; when
    /// more than the bound of messages wait, they are refused as well.
    pub(crate) fn push(&self, item: Item) -> Offered {
        let mut inner = self.lock();
        if inner.closed {
            return Offered::Closed;
        }
        if inner.items.len() >= 2 * self.bounds.messages {
            return Offered::Refused;
        }
        inner.items.push_back(item);
        drop(inner);
        self.arrived.notify_one();
        Offered::Accepted
    }

    /// No more offers; what is queued is still drained.
    pub(crate) fn close(&self) {
        self.lock().closed = true;
        self.arrived.notify_all();
    }

    /// Takes the next item, waiting for it until the queue closes or `timeout` passes.
    pub(crate) fn take(&self, timeout: Option<Duration>) -> Taken {
        let mut inner = self.lock();
        let idle = |inner: &mut Inner| inner.items.is_empty() && !inner.closed;
        inner = match timeout {
            None => self.arrived.wait_while(inner, idle).unwrap_or_else(PoisonError::into_inner),
            Some(timeout) => {
                let waited = self.arrived.wait_timeout_while(inner, timeout, idle);
                waited.unwrap_or_else(PoisonError::into_inner).0
            }
        };
        let item = inner.items.pop_front();
        if let Some(item) = &item {
            inner.messages -= item.messages().len();
            inner.bytes -= item.queued_bytes();
        }
        Taken { ended: item.is_none() && inner.closed, item, refused: std::mem::take(&mut inner.refused) }
    }

    /// Messages offered so far, by topic.
    pub(crate) fn offered(&self) -> BTreeMap<String, u64> {
        self.lock().offered.clone()
    }

    /// A thread that panicked while holding the lock left counters at worst one message off.
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    fn refuse(&mut self, batch: Vec<Message>, bounds: &QueueBounds) {
        for message in batch {
            self.refused.topic(&message.channel.topic).lost_in_queue += 1;
            let kept_limit_bytes = bounds.bytes + bounds.bytes / 8;
            let item = Item::Keep(message);
            let is_state = item.messages()[0].latch.key().is_some();
            if is_state && !self.closed && self.bytes + item.queued_bytes() <= kept_limit_bytes {
                self.messages += 1;
                self.bytes += item.queued_bytes();
                self.items.push_back(item);
            }
        }
    }
}

impl Item {
    fn messages(&self) -> &[Message] {
        match self {
            Item::Messages(batch) => batch,
            Item::Keep(message) => std::slice::from_ref(message),
            Item::Attach(_) | Item::Forget(_) | Item::Command(_) => &[],
        }
    }

    fn queued_bytes(&self) -> usize {
        self.messages().iter().map(Message::queued_bytes).sum()
    }
}
