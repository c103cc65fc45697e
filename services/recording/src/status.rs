//! What the recorder says about itself.

use std::path::PathBuf;

use serde::Serialize;

/// Whether it records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Not asked to record.
    #[default]
    Off,
    /// Recording.
    Recording,
    /// Asked to record and cannot; retries by itself.
    Failed,
}

/// A snapshot of the recorder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Default)]
pub struct Status {
    /// Whether it records.
    pub state: State,
    /// The file being written, or the last finished one.
    pub file: Option<PathBuf>,
    /// Bytes of that file.
    pub bytes: u64,
    /// Messages offered since the start.
    pub offered: u64,
    /// Messages stored for certain since the start.
    pub stored: u64,
    /// Messages lost since the start, in the queue or on disk.
    pub lost: u64,
    /// Bytes free on the recordings' file system, when known.
    pub free_bytes: Option<u64>,
    /// Why it failed, when it has.
    pub reason: Option<String>,
    /// Files finished since the start.
    pub files_finished: u64,
}
