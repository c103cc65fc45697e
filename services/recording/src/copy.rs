//! Copying a recording message by message: ids, order, times, metadata, attachments and compression stay.

use std::{
    collections::BTreeSet,
    fs::File,
    io::{BufWriter, Read},
    path::Path,
};

use mcap::{
    records::{MessageHeader, Metadata, Record, op},
    write::NoSeek,
};

use crate::{
    ChannelSpec, Compression, Ledger, Message, RecordingError, WriterOptions, chunk,
    recover::RecoverReport,
    scan::{self, End, Scanner},
    walk::{Fault, FaultKind, RecordedMessage, Step, Walk},
    writer::ACCOUNTS_RECORD,
};

/// What must be known of a file before it is copied.
pub(crate) struct Outline {
    /// Of the first chunk; `None` when the file has no chunk.
    compression: Option<String>,
    /// The summary section's records.
    pub(crate) summary: Vec<Record<'static>>,
    /// Bytes behind the last whole record, if the file is cut before the end of its data.
    pub(crate) cut_bytes: u64,
}

impl Outline {
    pub(crate) fn read(path: &Path) -> Result<Self, RecordingError> {
        let mut scanner = Scanner::open(path)?;
        let mut outline = Self { compression: None, summary: Vec::new(), cut_bytes: 0 };
        let mut after_data = false;
        while let Some(record) = scanner.next_record().map_err(RecordingError::io("cannot read", path))? {
            if record.opcode == op::CHUNK && outline.compression.is_none() {
                outline.compression = chunk::split(record.body).ok().map(|(header, _)| header.compression);
            } else if after_data && let Ok(parsed) = scan::parse(record.opcode, &record.body) {
                outline.summary.push(parsed.into_owned());
            } else {
                after_data |= record.opcode == op::DATA_END;
            }
        }
        if let (false, Some(End::Cut { offset, .. })) = (after_data, scanner.end()) {
            outline.cut_bytes = scanner.length().saturating_sub(*offset);
        }
        Ok(outline)
    }

    fn compression(&self, otherwise: Compression) -> Compression {
        match self.compression.as_deref() {
            Some("zstd") => Compression::Zstd,
            Some("lz4") => Compression::Lz4,
            Some("") => Compression::None,
            Some(_) | None => otherwise,
        }
    }
}

/// A copy being written.
pub(crate) struct Copying {
    mcap: mcap::Writer<NoSeek<BufWriter<File>>>,
    declared: BTreeSet<u16>,
    /// Behind the data section everything repeats what came before, and the writer writes its own.
    after_data: bool,
    /// The recorder's accounts, which are only true of the whole file.
    accounts: Option<Metadata>,
    /// Messages that the original does not have.
    added: Ledger,
    /// The number that the next channel of such messages gets: from the top, where recorders do not count to.
    next_added_id: u16,
}

impl Copying {
    pub(crate) fn begin(
        file: File,
        options: &WriterOptions,
        outline: &Outline,
    ) -> Result<Self, RecordingError> {
        let mcap = mcap::WriteOptions::new()
            .profile("")
            .library(&options.library)
            .compression(outline.compression(options.compression).as_mcap())
            .compression_threads(0)
            .chunk_size(Some(options.chunk_bytes as u64))
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::new(file)))?;
        Ok(Self {
            mcap,
            declared: BTreeSet::new(),
            after_data: false,
            accounts: None,
            added: Ledger::default(),
            next_added_id: u16::MAX,
        })
    }

    /// Copies what the next step says; returns it when it is a message, `None` at the end of the original.
    pub(crate) fn step(
        &mut self,
        walk: &mut Walk<impl Read>,
        report: &mut RecoverReport,
    ) -> Result<Option<Copied>, RecordingError> {
        let Some((offset, step)) = walk.next_step()? else { return Ok(None) };
        match step {
            Step::Chunk(_) => report.chunks += 1,
            Step::Message(message) => {
                self.message(&message)?;
                report.messages += 1;
                return Ok(Some(Copied::Message(message)));
            }
            Step::Record(record) => self.record(record)?,
            Step::Fault(kind) => {
                let chunk_lost = matches!(kind, FaultKind::Chunk(_));
                report.chunks = report.chunks.saturating_sub(u64::from(chunk_lost));
                report.faults.push(Fault { offset, kind });
            }
        }
        Ok(Some(Copied::Other))
    }

    /// Declares a channel that the original does not have; returns its number.
    pub(crate) fn declare(&mut self, spec: &ChannelSpec) -> Result<u16, RecordingError> {
        let id = self.next_added_id;
        self.next_added_id -= 1;
        let schema = &spec.schema;
        self.mcap.add_schema_with_id(id, &schema.name, "protobuf", &schema.file_descriptor_set)?;
        let metadata = spec.metadata();
        self.mcap.add_channel_with_id(id, id, &spec.topic, "protobuf", &metadata)?;
        Ok(id)
    }

    /// Adds a message on a channel that was declared here.
    pub(crate) fn add(&mut self, channel_id: u16, message: &Message) -> Result<(), RecordingError> {
        let header = MessageHeader {
            channel_id,
            sequence: message.sequence,
            log_time: message.log_time_ns,
            publish_time: message.publish_time_ns,
        };
        self.mcap.write_to_known_channel(&header, &message.data)?;
        self.added.topic(&message.channel.topic).stored += 1;
        Ok(())
    }

    /// Writes the accounts or, where the original was damaged, what is not in it any more; then the summary.
    pub(crate) fn finish(mut self, report: &RecoverReport) -> Result<(), RecordingError> {
        match self.accounts.take() {
            Some(accounts) if report.faults.is_empty() => {
                let mut metadata = accounts.metadata;
                metadata.extend(self.added.to_metadata());
                self.metadata(&Metadata { name: ACCOUNTS_RECORD.to_owned(), metadata })?;
            }
            _ => self.metadata(&report.to_metadata())?,
        }
        Ok(self.mcap.finish().map(drop)?)
    }

    pub(crate) fn metadata(&mut self, metadata: &Metadata) -> Result<(), RecordingError> {
        Ok(self.mcap.write_metadata(metadata)?)
    }

    pub(crate) fn attach(&mut self, attachment: &mcap::Attachment<'_>) -> Result<(), RecordingError> {
        Ok(self.mcap.attach(attachment)?)
    }

    fn message(&mut self, message: &RecordedMessage) -> Result<(), RecordingError> {
        let channel = &message.channel;
        if self.declared.insert(channel.id) {
            let schema_id = match &channel.schema {
                None => 0,
                Some(s) => self.mcap.add_schema_with_id(s.id, &s.name, &s.encoding, &s.data)?,
            };
            let (topic, encoding) = (&channel.topic, &channel.message_encoding);
            self.mcap.add_channel_with_id(channel.id, schema_id, topic, encoding, &channel.metadata)?;
        }
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: message.sequence,
            log_time: message.log_time_ns,
            publish_time: message.publish_time_ns,
        };
        Ok(self.mcap.write_to_known_channel(&header, &message.data)?)
    }

    fn record(&mut self, record: Record<'_>) -> Result<(), RecordingError> {
        match record {
            _ if self.after_data => {}
            Record::DataEnd(_) => self.after_data = true,
            Record::Metadata(metadata) if metadata.name == ACCOUNTS_RECORD => self.accounts = Some(metadata),
            Record::Metadata(metadata) => self.mcap.write_metadata(&metadata)?,
            Record::Attachment { header, data, .. } => self.mcap.attach(&mcap::Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            })?,
            _ => {}
        }
        Ok(())
    }
}

/// What one step copied.
pub(crate) enum Copied {
    /// A message.
    Message(RecordedMessage),
    /// Something else, or nothing.
    Other,
}
