//! Crash-safe MCAP recordings: writing, reading, recovery. Synchronous; knows nothing of Zenoh.
//!
//! Writing, outside in: [`Journal`] is the named thread with its bounded queue, [`Recorder`] the state
//! machine on that thread (time is an argument), [`FileWriter`] one MCAP file, [`Storage`] the disk.
//! Reading: [`scan`] frames records, [`reader`] yields messages of complete and of cut files, [`recover`]
//! makes a valid file from a damaged one.
//!
//! The crate knows bytes, topics and times, never message types: a [`ChannelSpec`] brings its schema name
//! and `FileDescriptorSet`. All times are nanoseconds since the Unix epoch, as MCAP has them.

mod account;
pub mod check;
mod chunk;
mod copy;
mod error;
pub mod excerpt;
mod file_name;
pub mod info;
mod journal;
mod latched;
mod message;
mod options;
mod pre_trigger;
mod queue;
pub mod reader;
mod recorder;
pub mod recover;
pub mod rewrite;
pub mod scan;
mod status;
mod storage;
pub mod summary;
#[cfg(test)]
mod testing;
pub mod timeline;
pub mod walk;
mod writer;

pub use account::{Ledger, TopicAccount};
pub use chunk::ChunkFault;
pub use error::RecordingError;
pub use file_name::FileName;
pub use journal::{Command, Journal, Report};
pub use message::{Attachment, ChannelSpec, Latch, LatchKey, Message, Schema};
pub use options::{Compression, JournalOptions, PreTrigger, QueueBounds, Retention, Rotation, WriterOptions};
pub use queue::Offered;
pub use recorder::{Now, Recorder};
pub use status::{State, Status};
pub use storage::{Disk, DiskFile, RecordingFile, Space, Storage};
pub use writer::FileWriter;
