//! How many results a second, over the last few seconds.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Counts events in a sliding window of time.
#[derive(Clone, Debug)]
pub(crate) struct RateMeter {
    span: Duration,
    events: VecDeque<Instant>,
}

/// More events than any camera has frames in the span; beyond it the rate reads low, memory stays bounded.
const MAX_EVENTS: usize = 2048;

impl RateMeter {
    /// A meter over the last `span`.
    #[must_use]
    pub(crate) fn over(span: Duration) -> Self {
        Self { span, events: VecDeque::new() }
    }

    /// An event at `now`.
    pub(crate) fn observe(&mut self, now: Instant) {
        if self.events.len() == MAX_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(now);
    }

    /// Events per second in the span before `now`.
    pub(crate) fn rate_hz(&mut self, now: Instant) -> f64 {
        while self.events.front().is_some_and(|&first| now.saturating_duration_since(first) > self.span) {
            self.events.pop_front();
        }
        match self.events.front() {
            Some(&first) if self.events.len() > 1 => {
                let spanned = now.saturating_duration_since(first).as_secs_f64();
                (self.events.len() - 1) as f64 / spanned.max(f64::EPSILON)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_events_leave_the_window() {
        let mut meter = RateMeter::over(Duration::from_secs(2));
        let begin = Instant::now();
        for event in 0..=20 {
            meter.observe(begin + Duration::from_millis(100 * event));
        }
        assert!((meter.rate_hz(begin + Duration::from_secs(2)) - 10.0).abs() < 1e-9);
        assert!(meter.rate_hz(begin + Duration::from_secs(10)).abs() < 1e-9);
    }
}
