//! Options of writing, with their defaults and the reasons for them.

use std::{collections::BTreeMap, path::PathBuf, time::Duration};

/// How chunks are compressed. See `recordings/README.md` for the measurement behind the default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// Not at all: cheapest, and right for JPEG, which does not compress.
    #[default]
    None,
    /// LZ4: cheap, for raw images and chatty structured topics.
    Lz4,
    /// Zstandard: smallest.
    Zstd,
}

impl Compression {
    pub(crate) fn as_mcap(self) -> Option<mcap::Compression> {
        match self {
            Compression::None => None,
            Compression::Lz4 => Some(mcap::Compression::Lz4),
            Compression::Zstd => Some(mcap::Compression::Zstd),
        }
    }
}

/// How one file is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WriterOptions {
    /// Chunk compression.
    pub compression: Compression,
    /// Uncompressed size at which a chunk is closed, bytes.
    pub chunk_bytes: usize,
    /// Longest time a message waits before its chunk is closed and synced to disk.
    pub flush_every: Duration,
    /// `library` of the MCAP header, e.g. `waymark/0.1.0 mcap/0.26`.
    pub library: String,
}

impl Default for WriterOptions {
    fn default() -> Self {
        Self {
            compression: Compression::default(),
            chunk_bytes: 1 << 20,
            flush_every: Duration::from_millis(400),
            library: format!("waymark/{} mcap/{}", env!("CARGO_PKG_VERSION"), mcap::VERSION),
        }
    }
}

/// When a new file is begun. Where a stream is recorded, the next file waits for its next keyframe, ten seconds at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rotation {
    /// Size after which the next message goes to a new file, bytes.
    pub max_bytes: u64,
    /// Age after which the next message goes to a new file.
    pub max_duration: Duration,
}

impl Default for Rotation {
    fn default() -> Self {
        Self { max_bytes: 1 << 30, max_duration: Duration::from_secs(600) }
    }
}

/// Which finished files of this vehicle are deleted, oldest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Retention {
    /// Bytes all finished files of this vehicle may take together.
    pub max_total_bytes: u64,
}

/// What is kept while recording is off, to be stored when it starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PreTrigger {
    /// Longest time kept, by receipt.
    pub duration: Duration,
    /// Most bytes kept.
    pub max_bytes: usize,
}

/// Bounds of the queue between the offering threads and the journal thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueueBounds {
    /// Most messages.
    pub messages: usize,
    /// Most bytes. Messages over [`QueueBounds::BULK_BYTES`] may fill seven eighths of it, so that on a slow
    /// disk registrations and logs outlive pictures.
    pub bytes: usize,
}

impl QueueBounds {
    /// Payload size from which a message counts as bulk, bytes.
    pub const BULK_BYTES: usize = 16 << 10;

    pub(crate) fn bulk_limit_bytes(&self) -> usize {
        self.bytes - self.bytes / 8
    }
}

impl Default for QueueBounds {
    fn default() -> Self {
        Self { messages: 8192, bytes: 32 << 20 }
    }
}

/// Everything a [`crate::Journal`] needs to know.
#[derive(Debug, Clone)]
pub struct JournalOptions {
    /// Where recordings go; created when missing.
    pub directory: PathBuf,
    /// Vehicle id, the first part of every file name.
    pub vehicle: String,
    /// Whether to record from the start or wait for [`crate::Command::Start`].
    pub begin: crate::Command,
    /// How files are written.
    pub writer: WriterOptions,
    /// When a new file is begun.
    pub rotation: Rotation,
    /// What is deleted; `None` deletes nothing.
    pub retention: Option<Retention>,
    /// Bytes recording leaves free on the file system, at most a twentieth of its size. With
    /// [`Retention`] old files make room; without, recording stops.
    pub free_floor_bytes: u64,
    /// What is kept while recording is off; `None` keeps nothing.
    pub pre_trigger: Option<PreTrigger>,
    /// Bounds of the queue.
    pub queue: QueueBounds,
    /// Metadata records written into each file: name → key → value (configuration without secrets, versions).
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
}

impl JournalOptions {
    /// Defaults for a vehicle's recordings in `directory`.
    pub fn new(directory: impl Into<PathBuf>, vehicle: impl Into<String>) -> Self {
        Self {
            directory: directory.into(),
            vehicle: vehicle.into(),
            begin: crate::Command::Start,
            writer: WriterOptions::default(),
            rotation: Rotation::default(),
            retention: None,
            free_floor_bytes: 256 << 20,
            pre_trigger: None,
            queue: QueueBounds::default(),
            metadata: BTreeMap::new(),
        }
    }
}
