//! How long the leader's own puts take: the proof that it waits for nobody.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use schemars::JsonSchema;
use serde::Serialize;

/// Puts that are remembered: about a minute, at a manifest and a status a second.
const REMEMBERED: usize = 128;

/// Wall times of puts.
#[derive(Debug, Default)]
pub(crate) struct PutTimes {
    recent: Mutex<Recent>,
}

#[derive(Debug, Default)]
struct Recent {
    count: u64,
    newest_last: VecDeque<Duration>,
}

/// What the last puts took.
#[derive(Clone, Copy, Debug, Default, PartialEq, JsonSchema, Serialize)]
pub(crate) struct PutStatus {
    /// Puts since the start.
    pub(crate) count: u64,
    /// The median of the last puts, ms; 0 before the first.
    pub(crate) median_ms: f64,
    /// The longest of them, ms; 0 before the first.
    pub(crate) longest_ms: f64,
}

impl PutTimes {
    /// Takes note of one put.
    pub(crate) fn took(&self, time: Duration) {
        let mut recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        recent.count += 1;
        if recent.newest_last.len() == REMEMBERED {
            recent.newest_last.pop_front();
        }
        recent.newest_last.push_back(time);
    }

    pub(crate) fn status(&self) -> PutStatus {
        let recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        let mut sorted: Vec<Duration> = recent.newest_last.iter().copied().collect();
        sorted.sort_unstable();
        let milliseconds = |time: Option<&Duration>| time.map_or(0.0, |time| time.as_secs_f64() * 1e3);
        PutStatus {
            count: recent.count,
            median_ms: milliseconds(sorted.get(sorted.len() / 2)),
            longest_ms: milliseconds(sorted.last()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_puts_are_forgotten_but_counted() {
        let times = PutTimes::default();
        assert_eq!(times.status(), PutStatus::default());
        times.took(Duration::from_secs(9));
        for _ in 0..REMEMBERED {
            times.took(Duration::from_millis(2));
        }
        let count = REMEMBERED as u64 + 1;
        assert_eq!(times.status(), PutStatus { count, median_ms: 2.0, longest_ms: 2.0 });
    }
}
