//! Capture time.

/// An instant of the capture clock: nanoseconds since the Unix epoch.
///
/// `vision` never reads a clock; whoever captured the frame says when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Timestamp {
    /// Nanoseconds since 1970-01-01T00:00:00Z, negative before it.
    pub nanos: i64,
}

impl Timestamp {
    /// The timestamp `nanos` nanoseconds after the Unix epoch.
    #[must_use]
    pub const fn from_nanos(nanos: i64) -> Self {
        Self { nanos }
    }

    /// Seconds from `earlier` to `self`, negative when the order is the other way round; never overflows.
    #[must_use]
    pub fn seconds_since(self, earlier: Self) -> f64 {
        (i128::from(self.nanos) - i128::from(earlier.nanos)) as f64 * 1e-9
    }
}
