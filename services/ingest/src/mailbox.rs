//! One slot between a stream that never waits and a thread that takes its time: the newest picture wins.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// A slot for one item. Putting never waits; an item that was not taken yet is replaced, and counted.
#[derive(Debug)]
pub struct Mailbox<T> {
    slot: Mutex<Slot<T>>,
    filled: Condvar,
}

#[derive(Debug)]
struct Slot<T> {
    item: Option<T>,
    replaced: u64,
    open: bool,
}

impl<T> Default for Mailbox<T> {
    fn default() -> Self {
        Self { slot: Mutex::new(Slot { item: None, replaced: 0, open: true }), filled: Condvar::new() }
    }
}

impl<T> Mailbox<T> {
    /// Puts `item` in the slot and wakes the taker. Returns what it replaced, or `item` itself when closed.
    pub fn put(&self, item: T) -> Option<T> {
        let mut slot = self.lock();
        if !slot.open {
            return Some(item);
        }
        let replaced = slot.item.replace(item);
        slot.replaced += u64::from(replaced.is_some());
        drop(slot);
        self.filled.notify_one();
        replaced
    }

    /// Waits for an item and takes it; `None` once the mailbox is closed and empty.
    pub fn take(&self) -> Option<T> {
        let mut slot = self
            .filled
            .wait_while(self.lock(), |slot| slot.item.is_none() && slot.open)
            .unwrap_or_else(PoisonError::into_inner);
        slot.item.take()
    }

    /// No more items come in; what is in the slot can still be taken.
    pub fn close(&self) {
        self.lock().open = false;
        self.filled.notify_all();
    }

    /// How many items were replaced before they were taken.
    pub fn replaced(&self) -> u64 {
        self.lock().replaced
    }

    /// A panic cannot leave the slot half written, so a poisoned lock is as good as any.
    fn lock(&self) -> MutexGuard<'_, Slot<T>> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::Mailbox;
    use std::sync::Arc;

    #[test]
    fn newest_wins_and_replaced_are_counted() {
        let mailbox = Mailbox::default();
        assert_eq!(mailbox.put(1), None);
        assert_eq!(mailbox.put(2), Some(1));
        assert_eq!(mailbox.take(), Some(2));
        assert_eq!(mailbox.replaced(), 1);
    }

    #[test]
    fn closing_wakes_the_taker_and_keeps_the_last_item() {
        let mailbox = Arc::new(Mailbox::<u8>::default());
        let taker = std::thread::spawn({
            let mailbox = Arc::clone(&mailbox);
            move || mailbox.take()
        });
        mailbox.close();
        assert_eq!(taker.join().unwrap(), None);
        assert_eq!(mailbox.put(3), Some(3), "closed: the item comes back");

        let full = Mailbox::default();
        full.put(4);
        full.close();
        assert_eq!(full.take(), Some(4));
        assert_eq!(full.take(), None);
    }
}
