//! What the web face turned away and cut off, for its owner's `/metrics`.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Why a request or a connection was turned away or cut off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Refusal {
    /// `Host` is not a name of this service.
    Host,
    /// A change that comes from another site.
    Origin,
    /// A change where only reading is allowed.
    ReadOnly,
    /// A change without the token.
    Token,
    /// The query is too long.
    Query,
    /// The body is too large or broke off.
    Body,
    /// The body took too long.
    SlowBody,
    /// No whole request header came in time; a connection that is kept open idle ends this way too.
    SlowHeader,
    /// Not HTTP, or an address or header beyond all limits.
    Unparseable,
    /// The client stopped reading.
    Stalled,
    /// Too many connections.
    Connections,
    /// Too many picture streams.
    Streams,
    /// Too many readers of events.
    Readers,
}

impl Refusal {
    /// Every reason.
    pub const ALL: [Self; 13] = [
        Self::Host,
        Self::Origin,
        Self::ReadOnly,
        Self::Token,
        Self::Query,
        Self::Body,
        Self::SlowBody,
        Self::SlowHeader,
        Self::Unparseable,
        Self::Stalled,
        Self::Connections,
        Self::Streams,
        Self::Readers,
    ];

    /// The label in metrics.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Origin => "origin",
            Self::ReadOnly => "read_only",
            Self::Token => "token",
            Self::Query => "query",
            Self::Body => "body",
            Self::SlowBody => "slow_body",
            Self::SlowHeader => "slow_header",
            Self::Unparseable => "unparseable",
            Self::Stalled => "stalled",
            Self::Connections => "connections",
            Self::Streams => "streams",
            Self::Readers => "readers",
        }
    }
}

/// Counts refusals; one for each listener, found by routes as `Extension<Arc<Counters>>`.
#[derive(Debug, Default)]
pub struct Counters {
    refused: Mutex<BTreeMap<Refusal, u64>>,
}

impl Counters {
    pub(crate) fn count(&self, refusal: Refusal) {
        let mut refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        *refused.entry(refusal).or_default() += 1;
    }

    /// Each reason with its count since the start, also those that never occurred.
    #[must_use]
    pub fn by_reason(&self) -> [(&'static str, u64); Refusal::ALL.len()] {
        let refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        Refusal::ALL.map(|refusal| (refusal.name(), refused.get(&refusal).copied().unwrap_or(0)))
    }
}
