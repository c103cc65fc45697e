//! A walk through a whole file, chunks unpacked, faults named and stepped over.

use std::{
    collections::{BTreeMap, VecDeque},
    fmt,
    fs::File,
    io::{BufReader, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

use bytes::Bytes;
use mcap::records::{ChunkHeader, MessageHeader, Record, SchemaHeader, op};

use crate::{
    RecordingError,
    chunk::{self, ChunkFault},
    scan::{self, End, RawRecord, Scanner},
};

/// A channel as the file declares it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedChannel {
    /// Its number in this file.
    pub id: u16,
    /// Topic.
    pub topic: String,
    /// Message encoding, `protobuf` in our recordings.
    pub message_encoding: String,
    /// Metadata; ours has `key_expression`.
    pub metadata: BTreeMap<String, String>,
    /// Schema, if it has one.
    pub schema: Option<Arc<RecordedSchema>>,
}

/// A schema as the file declares it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedSchema {
    /// Its number in this file.
    pub id: u16,
    /// Fully qualified message name.
    pub name: String,
    /// Schema encoding, `protobuf` in our recordings.
    pub encoding: String,
    /// A `FileDescriptorSet` for `protobuf`.
    pub data: Bytes,
}

/// A message of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedMessage {
    /// Its channel.
    pub channel: Arc<RecordedChannel>,
    /// Low 32 bits of the sender's sequence number.
    pub sequence: u32,
    /// Receipt, nanoseconds since the Unix epoch.
    pub log_time_ns: u64,
    /// Capture, nanoseconds since the Unix epoch.
    pub publish_time_ns: u64,
    /// The encoded message.
    pub data: Bytes,
}

/// What is wrong, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Where the faulty record begins in the file, bytes.
    pub offset: u64,
    /// What is wrong.
    pub kind: FaultKind,
}

/// Kinds of fault.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FaultKind {
    /// A chunk that cannot be used; its messages are gone.
    #[error("{0}")]
    Chunk(#[from] ChunkFault),
    /// The end of a chunk's data that frames no record.
    #[error("{0} bytes at the end of the chunk are no record")]
    ChunkTail(usize),
    /// A record whose fields do not fit its length, or whose CRC fails.
    #[error("record 0x{opcode:02x} cannot be read: {why}")]
    Record {
        /// What it is.
        opcode: u8,
        /// What is wrong with it.
        why: String,
    },
    /// A message on a channel never declared.
    #[error("message {sequence} on undeclared channel {channel}")]
    UnknownChannel {
        /// The channel.
        channel: u16,
        /// The message.
        sequence: u32,
    },
    /// A channel with a schema never declared.
    #[error("channel {topic:?} has undeclared schema {schema}")]
    UnknownSchema {
        /// The channel's topic.
        topic: String,
        /// The schema.
        schema: u16,
    },
    /// The file ends within a record or without its footer.
    #[error("file ends without its closing magic bytes: it was cut, or is still being written")]
    Cut,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at byte {}: {}", self.offset, self.kind)
    }
}

/// Whether a cut last chunk is searched for whole messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CutChunk {
    /// Its CRC cannot be checked, so it is left out.
    Skip,
    /// Whole records of it are taken on trust.
    Salvage,
}

/// One step of a [`Walk`].
#[derive(Debug)]
pub enum Step {
    /// A chunk begins.
    Chunk(ChunkHeader),
    /// A message, within a chunk or not.
    Message(RecordedMessage),
    /// Any other record, in file order, schemas and channels included.
    Record(Record<'static>),
    /// Something is wrong; the walk goes on behind it where it can.
    Fault(FaultKind),
}

/// An iterator over a file's [`Step`]s with the file offset each stands at (for records within a chunk, the
/// chunk's).
pub struct Walk<R> {
    path: PathBuf,
    scanner: Scanner<R>,
    cut_chunk: CutChunk,
    schemas: BTreeMap<u16, Arc<RecordedSchema>>,
    channels: BTreeMap<u16, Arc<RecordedChannel>>,
    /// The rest of the current chunk and where the chunk begins.
    chunk: Option<(u64, Bytes)>,
    ready: VecDeque<(u64, Step)>,
    ended: bool,
}

impl Walk<BufReader<File>> {
    /// Walks the file `path`.
    pub fn open(path: &Path, cut_chunk: CutChunk) -> Result<Self, RecordingError> {
        Ok(Self::new(Scanner::open(path)?, path, cut_chunk))
    }
}

impl<R: Read> Walk<R> {
    /// Walks what `scanner` finds; `path` stands in errors.
    pub fn new(scanner: Scanner<R>, path: &Path, cut_chunk: CutChunk) -> Self {
        Self {
            path: path.to_owned(),
            scanner,
            cut_chunk,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            chunk: None,
            ready: VecDeque::new(),
            ended: false,
        }
    }

    /// The next step; `None` at the end, which was clean unless the last step was [`FaultKind::Cut`].
    pub fn next_step(&mut self) -> Result<Option<(u64, Step)>, RecordingError> {
        loop {
            if let Some(step) = self.ready.pop_front() {
                return Ok(Some(step));
            }
            if let Some((offset, mut plain)) = self.chunk.take() {
                self.step_in_chunk(offset, &mut plain);
                continue;
            }
            if self.ended {
                return Ok(None);
            }
            match self.scanner.next_record().map_err(RecordingError::io("cannot read", &self.path))? {
                Some(record) => self.top_level(&record),
                None => self.end(),
            }
        }
    }

    /// Declares beforehand what the file declares in its summary, for files whose first declarations are lost.
    pub fn predeclare(&mut self, summary: &[Record<'static>]) {
        for record in summary {
            // A summary that contradicts itself declares what it can.
            let _ = self.declare(record);
        }
    }

    /// Channels declared so far.
    pub fn channels(&self) -> impl Iterator<Item = &Arc<RecordedChannel>> {
        self.channels.values()
    }

    fn top_level(&mut self, record: &RawRecord) {
        if record.opcode != op::CHUNK {
            return self.record(record.offset, record.opcode, &record.body);
        }
        match chunk::split(record.body.clone()) {
            Ok((header, data)) => {
                let (plain, fault) = chunk::unpack(&header, &data);
                self.ready.push_back((record.offset, Step::Chunk(header)));
                match fault {
                    None => self.chunk = Some((record.offset, plain)),
                    Some(fault) => self.fault(record.offset, fault.into()),
                }
            }
            Err(fault) => self.fault(record.offset, fault.into()),
        }
    }

    fn end(&mut self) {
        self.ended = true;
        let Some(End::Cut { offset, partial }) = self.scanner.end().cloned() else { return };
        if let (CutChunk::Salvage, Some(partial)) = (self.cut_chunk, partial)
            && partial.opcode == op::CHUNK
            && let Ok((header, data)) = chunk::split(partial.body)
        {
            let (mut plain, _cut) = chunk::unpack(&header, &data);
            self.ready.push_back((offset, Step::Chunk(header)));
            while let Some(inner) = chunk::take_record(&mut plain) {
                self.record(offset, inner.opcode, &inner.body);
            }
        }
        self.fault(offset, FaultKind::Cut);
    }

    fn step_in_chunk(&mut self, offset: u64, plain: &mut Bytes) {
        match chunk::take_record(plain) {
            Some(inner) => {
                self.record(offset, inner.opcode, &inner.body);
                self.chunk = Some((offset, plain.clone()));
            }
            None if plain.is_empty() => {}
            None => self.fault(offset, FaultKind::ChunkTail(plain.len())),
        }
    }

    fn record(&mut self, offset: u64, opcode: u8, body: &Bytes) {
        let step = match scan::parse(opcode, body) {
            // The data is a slice of the chunk, not a copy.
            Ok(Record::Message { header, data }) => self.message(&header, body.slice_ref(&data)),
            Ok(record) => self.declare(&record).map(|()| Step::Record(record.into_owned())),
            Err(error) => Err(FaultKind::Record { opcode, why: error.to_string() }),
        };
        self.ready.push_back((offset, step.unwrap_or_else(Step::Fault)));
    }

    fn message(&self, header: &MessageHeader, data: Bytes) -> Result<Step, FaultKind> {
        let channel = self
            .channels
            .get(&header.channel_id)
            .ok_or(FaultKind::UnknownChannel { channel: header.channel_id, sequence: header.sequence })?;
        Ok(Step::Message(RecordedMessage {
            channel: Arc::clone(channel),
            sequence: header.sequence,
            log_time_ns: header.log_time,
            publish_time_ns: header.publish_time,
            data,
        }))
    }

    fn declare(&mut self, record: &Record<'_>) -> Result<(), FaultKind> {
        match record {
            Record::Schema { header, data } => self.declare_schema(header, data),
            Record::Channel(channel) => self.declare_channel(channel)?,
            _ => {}
        }
        Ok(())
    }

    fn declare_schema(&mut self, header: &SchemaHeader, data: &[u8]) {
        let SchemaHeader { id, name, encoding } = header.clone();
        let data = Bytes::copy_from_slice(data);
        self.schemas.entry(id).or_insert_with(|| Arc::new(RecordedSchema { id, name, encoding, data }));
    }

    fn declare_channel(&mut self, channel: &mcap::records::Channel) -> Result<(), FaultKind> {
        let schema = match channel.schema_id {
            0 => None,
            id => Some(
                self.schemas
                    .get(&id)
                    .cloned()
                    .ok_or_else(|| FaultKind::UnknownSchema { topic: channel.topic.clone(), schema: id })?,
            ),
        };
        self.channels.entry(channel.id).or_insert_with(|| {
            Arc::new(RecordedChannel {
                id: channel.id,
                topic: channel.topic.clone(),
                message_encoding: channel.message_encoding.clone(),
                metadata: channel.metadata.clone(),
                schema,
            })
        });
        Ok(())
    }

    fn fault(&mut self, offset: u64, kind: FaultKind) {
        self.ready.push_back((offset, Step::Fault(kind)));
    }
}

impl<R: Read> Iterator for Walk<R> {
    type Item = Result<(u64, Step), RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_step().transpose()
    }
}
