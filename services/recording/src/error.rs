//! What can go wrong with a recording.

use std::{io, path::PathBuf};

/// Why a recording could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The operating system refused.
    #[error("{doing} {path}: {source}", path = path.display())]
    Io {
        /// What was tried, e.g. `cannot create`.
        doing: &'static str,
        /// On what.
        path: PathBuf,
        /// The operating system's answer.
        source: io::Error,
    },
    /// The disk refused, most often because it is full.
    #[error("cannot write the recording: {0}")]
    Write(io::Error),
    /// The MCAP library refused.
    #[error("cannot write MCAP: {0}")]
    Mcap(mcap::McapError),
    /// There is less room than the floor leaves.
    #[error(
        "disk full: {free_bytes} bytes free, {needed_bytes} needed; delete recordings or lower the floor"
    )]
    NoRoom {
        /// Bytes free on the recordings' file system.
        free_bytes: u64,
        /// The floor that recording leaves free and, after a failure, some more to begin again.
        needed_bytes: u64,
    },
    /// The vehicle id cannot stand in a file name.
    #[error("vehicle id {0:?} is not allowed: use [a-z0-9][a-z0-9_-]{{0,62}}")]
    BadVehicle(String),
    /// Every name tried was taken.
    #[error("no free file name beside {0:?}: move old recordings away")]
    NoFreeName(String),
    /// The file is no MCAP file at all.
    #[error("{path} does not begin with the MCAP magic bytes", path = .0.display())]
    NotMcap(PathBuf),
    /// The file has a fault where strict reading demands none.
    #[error("{path} at byte {offset}: {fault}", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where the faulty record begins.
        offset: u64,
        /// What is wrong.
        fault: String,
    },
}

impl RecordingError {
    /// Wraps an operating system error with what was being done and on what.
    pub(crate) fn io(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| RecordingError::Io { doing, path, source }
    }
}

impl From<mcap::McapError> for RecordingError {
    fn from(error: mcap::McapError) -> Self {
        match error {
            // The library's own message for these leaves the cause out.
            mcap::McapError::Io(source) => RecordingError::Write(source),
            other => RecordingError::Mcap(other),
        }
    }
}
