//! What is recorded: bytes on a channel, with their times.

use std::{collections::BTreeMap, sync::Arc};

use bytes::Bytes;

/// A protobuf schema as MCAP wants it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    /// Fully qualified message name, e.g. `foxglove.CompressedImage`.
    pub name: String,
    /// Serialised `FileDescriptorSet` with all imports.
    pub file_descriptor_set: Bytes,
}

/// A topic and how to read it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelSpec {
    /// Topic in the file, e.g. `/car-1/camera/front/image`.
    pub topic: String,
    /// Key expression the messages came from; kept in the channel's metadata as `key_expression`.
    pub key_expression: String,
    /// Schema of every message on this channel.
    pub schema: Schema,
}

impl ChannelSpec {
    /// What the channel's record says beside topic and schema.
    pub(crate) fn metadata(&self) -> BTreeMap<String, String> {
        BTreeMap::from([("key_expression".to_owned(), self.key_expression.clone())])
    }
}

/// Names a latched value: a newer message with the same key replaces it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LatchKey(pub String);

/// Whether a message is state that every file must hold at its head, so that the file stands alone.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Latch {
    /// An event: stored once.
    #[default]
    None,
    /// An event that rests on those before it on its channel, such as a picture of a video between two keyframes:
    /// while the channel still sends others, a new file begins with one of those.
    Continues,
    /// State: stored when it arrives and repeated at the head of every later file (landmarks, calibration).
    Repeat(LatchKey),
    /// State too frequent to store each time, which each message of topic `of` changes (a camera's `Follow` state
    /// and its pictures; both carry the picture's publish time): stored at the head of each file, then until it
    /// includes the file's first message of that topic, because some were in flight when the file began, and
    /// every five seconds, so that what comes after a loss can be made sense of again.
    Snapshot {
        /// Which state.
        key: LatchKey,
        /// The topic of what changes it.
        of: Arc<str>,
    },
}

impl Latch {
    pub(crate) fn key(&self) -> Option<&LatchKey> {
        match self {
            Latch::None | Latch::Continues => None,
            Latch::Repeat(key) | Latch::Snapshot { key, .. } => Some(key),
        }
    }
}

/// One message to record.
#[derive(Debug, Clone)]
pub struct Message {
    /// Where it belongs.
    pub channel: Arc<ChannelSpec>,
    /// Receipt, nanoseconds since the Unix epoch.
    pub log_time_ns: u64,
    /// Capture, nanoseconds since the Unix epoch.
    pub publish_time_ns: u64,
    /// Low 32 bits of the sender's sequence number.
    pub sequence: u32,
    /// The encoded protobuf message.
    pub data: Bytes,
    /// Whether it is repeated at the head of later files.
    pub latch: Latch,
}

impl Message {
    /// Memory it holds while queued, bytes: payload plus bookkeeping.
    pub(crate) fn queued_bytes(&self) -> usize {
        self.data.len() + size_of::<Message>()
    }
}

/// A file within the recording, such as the landmark set as JSON. The newest of each name is written into
/// every file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Name shown to the reader, e.g. `landmarks.json`.
    pub name: String,
    /// Media type, e.g. `application/json`.
    pub media_type: String,
    /// When it came into force, nanoseconds since the Unix epoch.
    pub log_time_ns: u64,
    /// Its content.
    pub data: Bytes,
}
