//! When a recorded moment is due: pure, the clock is an argument.

use std::time::{Duration, Instant};

use crate::error::PlayError;

/// How fast recorded time passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate(f64);

impl Rate {
    /// As recorded.
    pub const RECORDED: Self = Self(1.0);

    /// Recorded seconds per second; 0 for as fast as possible.
    ///
    /// # Errors
    /// When it is neither 0 nor within 0.01 and 1000.
    pub fn new(rate: f64) -> Result<Self, PlayError> {
        let allowed = rate == 0.0 || (0.01..=1000.0).contains(&rate);
        if allowed { Ok(Self(rate)) } else { Err(PlayError::Rate(rate)) }
    }

    /// So many times as fast, within the limits; as fast as possible stays so.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        if self.0 == 0.0 { self } else { Self((self.0 * factor).clamp(0.01, 1000.0)) }
    }

    /// The number.
    #[must_use]
    pub fn get(self) -> f64 {
        self.0
    }
}

/// The relation between recorded time and the clock.
#[derive(Clone, Copy, Debug)]
pub struct Tempo {
    rate: Rate,
    /// A recorded moment, and when it was or is due.
    anchor: (u64, Instant),
    paused: bool,
}

impl Tempo {
    /// Recorded time `recorded_ns` is due `now`.
    #[must_use]
    pub fn new(rate: Rate, recorded_ns: u64, now: Instant) -> Self {
        Self { rate, anchor: (recorded_ns, now), paused: false }
    }

    /// When a recorded moment is due; `None` while paused.
    #[must_use]
    pub fn due(&self, recorded_ns: u64) -> Option<Instant> {
        let (anchor_ns, at) = self.anchor;
        if self.paused {
            return None;
        }
        if self.rate.0 == 0.0 {
            return Some(at);
        }
        let elapsed = Duration::from_nanos(recorded_ns.saturating_sub(anchor_ns)).as_secs_f64() / self.rate.0;
        // A recording of centuries, played slowly: due never.
        Duration::try_from_secs_f64(elapsed).ok().and_then(|elapsed| at.checked_add(elapsed))
    }

    /// The recorded moment `recorded_ns` is due `now`, and what follows from there.
    pub fn anchor(&mut self, recorded_ns: u64, now: Instant) {
        self.anchor = (recorded_ns, now);
    }

    /// Changes the rate from the recorded moment that is due `now` on.
    pub fn set_rate(&mut self, rate: Rate, position_ns: u64, now: Instant) {
        self.anchor = (position_ns, now);
        self.rate = rate;
    }

    /// Stops at the recorded moment that is due `now`, or goes on from it.
    pub fn set_paused(&mut self, paused: bool, position_ns: u64, now: Instant) {
        self.anchor = (position_ns, now);
        self.paused = paused;
    }

    /// Whether it is stopped.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// How fast recorded time passes.
    #[must_use]
    pub fn rate(&self) -> Rate {
        self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_due_by_rate() {
        let now = Instant::now();
        let mut tempo = Tempo::new(Rate::RECORDED, 1_000, now);
        assert_eq!(tempo.due(2_001_000), Some(now + Duration::from_millis(2)));
        assert_eq!(tempo.due(0), Some(now), "what came before is due at once");
        tempo.set_rate(Rate::new(4.0).unwrap(), 1_000, now);
        assert_eq!(tempo.due(2_001_000), Some(now + Duration::from_micros(500)));
        tempo.set_rate(Rate::new(0.0).unwrap(), 1_000, now);
        assert_eq!(tempo.due(u64::MAX), Some(now));
    }

    #[test]
    fn a_pause_moves_everything_behind_it() {
        let now = Instant::now();
        let mut tempo = Tempo::new(Rate::RECORDED, 0, now);
        tempo.set_paused(true, 500, now + Duration::from_nanos(500));
        assert_eq!(tempo.due(900), None);
        let later = now + Duration::from_secs(9);
        tempo.set_paused(false, 500, later);
        assert_eq!(tempo.due(900), Some(later + Duration::from_nanos(400)));
    }

    #[test]
    fn rates_are_bounded() {
        let fastest = Rate::new(0.0).unwrap();
        assert_eq!((Rate::RECORDED.scaled(1e9).get(), fastest.scaled(2.0)), (1000.0, fastest));
        for rate in [-1.0, 0.001, 1001.0, f64::NAN, f64::INFINITY] {
            assert!(Rate::new(rate).is_err(), "{rate}");
        }
    }
}
