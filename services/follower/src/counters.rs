//! What went another way than planned, counted; read by status and metrics.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Landmarks and manifests that changed nothing.
#[derive(Debug, Default)]
pub(crate) struct LandmarkCounters {
    refused: AtomicU64,
    older: AtomicU64,
    conflicts: AtomicU64,
    deferred: AtomicU64,
}

impl LandmarkCounters {
    pub(crate) fn refused(&self) {
        self.refused.fetch_add(1, Relaxed);
    }

    pub(crate) fn older(&self) {
        self.older.fetch_add(1, Relaxed);
    }

    pub(crate) fn conflict(&self) {
        self.conflicts.fetch_add(1, Relaxed);
    }

    pub(crate) fn deferred(&self) {
        self.deferred.fetch_add(1, Relaxed);
    }

    /// Each reason with its count.
    #[must_use]
    pub(crate) fn by_reason(&self) -> [(&'static str, u64); 4] {
        [
            ("refused", self.refused.load(Relaxed)),
            ("older", self.older.load(Relaxed)),
            ("conflict", self.conflicts.load(Relaxed)),
            ("deferred", self.deferred.load(Relaxed)),
        ]
    }
}

/// Pictures that did not reach their camera's mailbox.
#[derive(Debug, Default)]
pub(crate) struct IntakeCounters {
    missed: AtomicU64,
    refused: AtomicU64,
}

impl IntakeCounters {
    pub(crate) fn set_missed(&self, missed: u64) {
        self.missed.store(missed, Relaxed);
    }

    pub(crate) fn refused(&self) {
        self.refused.fetch_add(1, Relaxed);
    }

    /// Pictures that were sent and did not arrive, by the gaps in their sequence.
    #[must_use]
    pub(crate) fn missed_count(&self) -> u64 {
        self.missed.load(Relaxed)
    }

    /// Samples that were too large or no pictures.
    #[must_use]
    pub(crate) fn refused_count(&self) -> u64 {
        self.refused.load(Relaxed)
    }
}
