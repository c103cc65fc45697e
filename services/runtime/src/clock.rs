//! How far another machine's clock is off, measured by asking it.
//!
//! The method is NTP's on-wire protocol (RFC 5905, section 8): with the request sent at t₁ and received at t₂ by the
//! other clock, the reply sent at t₃ by the other clock and received at t₄,
//! offset = ((t₂ − t₁) + (t₃ − t₄)) / 2 and round trip = (t₄ − t₁) − (t₃ − t₂). The offset is wrong by at most half the
//! round trip; of several exchanges the one with the shortest counts.

use serde::Serialize;

/// Beyond this, the times of two machines do not tell which of two frames at 30 Hz was first.
const MAX_OFFSET_NS: u64 = 33_000_000;

/// One exchange of question and answer; all times ns since the Unix epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// t₁, our clock.
    pub asked_at_ns: i64,
    /// t₂, the other clock.
    pub received_at_ns: i64,
    /// t₃, the other clock.
    pub answered_at_ns: i64,
    /// t₄, our clock.
    pub heard_at_ns: i64,
}

/// What an exchange says of the other clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ClockOffset {
    /// The other clock minus ours, in ns.
    pub offset_ns: i64,
    /// Time on the way there and back, in ns; the offset is known to half of it.
    pub round_trip_ns: i64,
}

impl Exchange {
    /// The offset that this exchange shows; `None` when our clock was set meanwhile, or a figure does not fit.
    #[must_use]
    pub fn offset(&self) -> Option<ClockOffset> {
        let there = i128::from(self.received_at_ns) - i128::from(self.asked_at_ns);
        let back = i128::from(self.answered_at_ns) - i128::from(self.heard_at_ns);
        let offset_ns = i64::try_from((there + back) / 2).ok()?;
        let round_trip_ns = i64::try_from(there - back).ok().filter(|round_trip| *round_trip >= 0)?;
        Some(ClockOffset { offset_ns, round_trip_ns })
    }
}

impl ClockOffset {
    /// How far the offset may be wrong, in ns either way.
    #[must_use]
    pub fn uncertainty_ns(&self) -> i64 {
        self.round_trip_ns / 2
    }

    /// Whether both clocks may agree to within a frame at 30 Hz; only what is certain counts against it.
    #[must_use]
    pub fn is_in_step(&self) -> bool {
        self.offset_ns.unsigned_abs() <= MAX_OFFSET_NS.saturating_add(self.uncertainty_ns().unsigned_abs())
    }
}

/// The best of several exchanges with one machine.
pub fn best_offset(exchanges: impl IntoIterator<Item = Exchange>) -> Option<ClockOffset> {
    let offsets = exchanges.into_iter().filter_map(|exchange| exchange.offset());
    offsets.min_by_key(|offset| offset.round_trip_ns)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_shortest_round_trip_counts() {
        let near = Exchange { asked_at_ns: 0, received_at_ns: 1_010, answered_at_ns: 1_020, heard_at_ns: 30 };
        let far = Exchange { heard_at_ns: 1_030, ..near };
        let best = best_offset([far, near]).unwrap();
        assert_eq!(best, ClockOffset { offset_ns: 1_000, round_trip_ns: 20 });
    }

    #[test]
    fn a_clock_that_was_set_back_says_nothing() {
        let set_back = Exchange { asked_at_ns: 100, received_at_ns: 5, answered_at_ns: 6, heard_at_ns: 50 };
        assert_eq!(best_offset([set_back]), None);
    }

    #[test]
    fn only_what_is_certain_counts_against_a_clock() {
        let in_step = |offset_ns, round_trip_ns| ClockOffset { offset_ns, round_trip_ns }.is_in_step();
        assert!(in_step(-30_000_000, 2_000_000));
        assert!(in_step(40_000_000, 20_000_000));
        assert!(!in_step(40_000_000, 2_000_000));
        assert!(!in_step(i64::MIN, 0));
    }

    proptest! {
        #[test]
        fn the_offset_is_right_to_half_the_round_trip(
            offset in -1_000_000_000i64..1_000_000_000,
            (there, work, back) in (0i64..1_000_000, 0i64..1_000_000, 0i64..1_000_000),
        ) {
            let received_at_ns = there + offset;
            let answered_at_ns = received_at_ns + work;
            let heard_at_ns = there + work + back;
            let exchange = Exchange { asked_at_ns: 0, received_at_ns, answered_at_ns, heard_at_ns };
            let measured = exchange.offset().unwrap();
            prop_assert_eq!(measured.round_trip_ns, there + back);
            prop_assert!((measured.offset_ns - offset).abs() <= measured.round_trip_ns / 2 + 1);
        }

        #[test]
        fn no_figures_make_it_panic(
            (asked_at_ns, received_at_ns, answered_at_ns, heard_at_ns) in any::<(i64, i64, i64, i64)>(),
        ) {
            let _ = Exchange { asked_at_ns, received_at_ns, answered_at_ns, heard_at_ns }.offset();
        }
    }
}
