//! What a recording holds: topics, counts, times, rates, gaps, losses, metadata, attachments, faults.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use mcap::records::{ChunkHeader, Record};

use crate::{
    Ledger, RecordingError,
    walk::{CutChunk, Fault, RecordedMessage, Step, Walk},
    writer::ACCOUNTS_RECORD,
};

/// A recording's contents at a glance, counted by reading all of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Info {
    /// The file.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// `profile` of the header; empty in our recordings.
    pub profile: String,
    /// `library` of the header.
    pub library: String,
    /// Topics in order of name.
    pub topics: BTreeMap<String, TopicInfo>,
    /// Chunks by compression; the empty name is none.
    pub chunks: BTreeMap<String, ChunkInfo>,
    /// Metadata records, name → key → value; the last of each name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Attachments in file order.
    pub attachments: Vec<AttachmentInfo>,
    /// The recorder's accounts, if it finished the file.
    pub accounts: Option<Ledger>,
    /// What is wrong with the file; a cut file has one of kind `Cut`.
    pub faults: Vec<Fault>,
}

/// One topic of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TopicInfo {
    /// Schema name; empty without one.
    pub schema: String,
    /// Key expression the messages came from, when known.
    pub key_expression: Option<String>,
    /// Messages.
    pub messages: u64,
    /// Payload bytes.
    pub bytes: u64,
    /// Earliest and latest log time, nanoseconds since the Unix epoch.
    pub log_span_ns: Option<(u64, u64)>,
    /// Longest time between one message and the next, and when it began, nanoseconds.
    pub longest_gap: Option<Gap>,
    /// Sequence numbers skipped: messages that never arrived at the recorder, as far as numbering shows.
    pub sequences_skipped: u64,
    /// The last message's log time and sequence.
    last: Option<(u64, u32)>,
}

/// A time without messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// Log time of the message before, nanoseconds since the Unix epoch.
    pub after_ns: u64,
    /// How long until the next message, nanoseconds.
    pub length_ns: u64,
}

/// Chunks of one compression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ChunkInfo {
    /// Chunks.
    pub count: u64,
    /// Bytes as stored.
    pub compressed_bytes: u64,
    /// Bytes of records within.
    pub uncompressed_bytes: u64,
}

/// A file within the recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AttachmentInfo {
    /// Its name.
    pub name: String,
    /// Media type.
    pub media_type: String,
    /// When it came into force, nanoseconds since the Unix epoch.
    pub log_time_ns: u64,
    /// Its content.
    pub data: bytes::Bytes,
}

impl Info {
    /// Reads all of `path`, complete or not; faults are reported within.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let bytes = fs::metadata(path).map_err(RecordingError::io("cannot read the size of", path))?.len();
        let mut info = Info { path: path.to_owned(), bytes, ..Info::default() };
        let mut walk = Walk::open(path, CutChunk::Skip)?;
        while let Some((offset, step)) = walk.next_step()? {
            match step {
                Step::Chunk(header) => {
                    info.chunks.entry(header.compression.clone()).or_default().count(&header)
                }
                Step::Message(message) => {
                    // Most lookups succeed: the key is only copied for a topic's first message.
                    match info.topics.get_mut(&message.channel.topic) {
                        Some(topic) => topic.count(&message),
                        None => info.topics.entry(message.channel.topic.clone()).or_default().count(&message),
                    }
                }
                Step::Record(record) => info.note(record),
                Step::Fault(kind) => info.faults.push(Fault { offset, kind }),
            }
        }
        Ok(info)
    }

    /// Messages on all topics.
    pub fn messages(&self) -> u64 {
        self.topics.values().map(|topic| topic.messages).sum()
    }

    /// Earliest and latest log time of all topics, nanoseconds since the Unix epoch.
    pub fn log_span_ns(&self) -> Option<(u64, u64)> {
        self.topics.values().filter_map(|topic| topic.log_span_ns).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    fn note(&mut self, record: Record<'_>) {
        match record {
            Record::Header(header) => (self.profile, self.library) = (header.profile, header.library),
            Record::Metadata(metadata) => {
                if metadata.name == ACCOUNTS_RECORD {
                    self.accounts = Some(Ledger::from_metadata(&metadata.metadata));
                }
                self.metadata.insert(metadata.name, metadata.metadata);
            }
            Record::Attachment { header, data, .. } => self.attachments.push(AttachmentInfo {
                name: header.name,
                media_type: header.media_type,
                log_time_ns: header.log_time,
                data: data.into_owned().into(),
            }),
            _ => {}
        }
    }
}

impl TopicInfo {
    /// Messages per second between the first and the last; `None` where these are less than a second apart, as with the
    /// landmarks at a file's head.
    pub fn rate_hz(&self) -> Option<f64> {
        let (first_ns, last_ns) = self.log_span_ns.filter(|(first, last)| last - first >= 1_000_000_000)?;
        Some((self.messages - 1) as f64 / ((last_ns - first_ns) as f64 * 1e-9))
    }

    fn count(&mut self, message: &RecordedMessage) {
        let (log_time_ns, sequence) = (message.log_time_ns, message.sequence);
        if self.messages == 0 {
            self.schema =
                message.channel.schema.as_ref().map_or_else(String::new, |schema| schema.name.clone());
            self.key_expression = message.channel.metadata.get("key_expression").cloned();
        }
        self.messages += 1;
        self.bytes += message.data.len() as u64;
        let (first_ns, last_ns) = self.log_span_ns.unwrap_or((log_time_ns, log_time_ns));
        self.log_span_ns = Some((first_ns.min(log_time_ns), last_ns.max(log_time_ns)));
        if let Some((before_ns, before_sequence)) = self.last.replace((log_time_ns, sequence)) {
            let gap = Gap { after_ns: before_ns, length_ns: log_time_ns.saturating_sub(before_ns) };
            if self.longest_gap.is_none_or(|longest| longest.length_ns < gap.length_ns) {
                self.longest_gap = Some(gap);
            }
            // Repeats, restarts of the sender and reordering go backwards; the number wraps at 32 bits.
            let step = sequence.wrapping_sub(before_sequence);
            if step < u32::MAX / 2 {
                self.sequences_skipped += u64::from(step.saturating_sub(1));
            }
        }
    }
}

impl ChunkInfo {
    fn count(&mut self, header: &ChunkHeader) {
        self.count += 1;
        self.compressed_bytes += header.compressed_size;
        self.uncompressed_bytes += header.uncompressed_size;
    }
}
