//! What was read of the recordings that were looked at last, so that scrubbing does not read it again.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::Found;

/// A timeline of an hour at 30 Hz has about 2 MB.
const MAX_KEPT: usize = 4;

#[derive(Debug)]
pub(super) struct Recent<T> {
    /// By name and entity tag, the one used last in front.
    kept: Mutex<VecDeque<(String, Arc<T>)>>,
}

impl<T> Default for Recent<T> {
    fn default() -> Self {
        Self { kept: Mutex::default() }
    }
}

impl<T> Recent<T> {
    /// What `read` gives of a recording, or gave as long as that has not changed.
    pub(super) fn of<E>(&self, found: &Found, read: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let key = format!("{} {}", found.name, found.tag);
        if let Some(known) = self.kept_as(&key) {
            return Ok(known);
        }
        let fresh = Arc::new(read()?);
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push_front((key, Arc::clone(&fresh)));
        kept.truncate(MAX_KEPT);
        Ok(fresh)
    }

    fn kept_as(&self, key: &str) -> Option<Arc<T>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|(known, _)| known == key)?;
        let entry = kept.remove(at)?;
        let known = Arc::clone(&entry.1);
        kept.push_front(entry);
        Some(known)
    }
}
