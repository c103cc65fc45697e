//! Recovery: a new, valid file with everything that can be read of a cut or damaged one.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::BufWriter,
    path::{Path, PathBuf},
};

use mcap::{
    records::{MessageHeader, Metadata, Record, op},
    write::NoSeek,
};

use crate::{
    Compression, RecordingError, WriterOptions, chunk,
    scan::{self, End, Scanner},
    walk::{CutChunk, Fault, FaultKind, RecordedMessage, Step, Walk},
    writer::ACCOUNTS_RECORD,
};

mod leftovers;

pub use leftovers::{Leftover, Leftovers, recover_directory};

/// What recovery found and kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecoverReport {
    /// The damaged file.
    pub input: PathBuf,
    /// The new file.
    pub output: PathBuf,
    /// Messages kept.
    pub messages: u64,
    /// Whole chunks kept.
    pub chunks: u64,
    /// Faults found; empty when the file was complete.
    pub faults: Vec<Fault>,
    /// Bytes of the input behind its last whole record; zero when only the summary was cut, which is rebuilt.
    pub cut_bytes: u64,
}

impl RecoverReport {
    /// Whether something that was in the file is not in the new one.
    pub fn lost_data(&self) -> bool {
        self.cut_bytes > 0 || self.faults.iter().any(|fault| fault.kind != FaultKind::Cut)
    }

    fn to_metadata(&self) -> Metadata {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let faults: Vec<String> = self.faults.iter().map(Fault::to_string).collect();
        let metadata = BTreeMap::from([
            ("input".to_owned(), name(&self.input)),
            ("messages".to_owned(), self.messages.to_string()),
            ("chunks".to_owned(), self.chunks.to_string()),
            ("cut_bytes".to_owned(), self.cut_bytes.to_string()),
            ("lost_data".to_owned(), self.lost_data().to_string()),
            ("faults".to_owned(), faults.join("\n")),
        ]);
        Metadata { name: RECOVERY_RECORD.to_owned(), metadata }
    }
}

/// Name of the metadata record that a recovered file carries.
pub(crate) const RECOVERY_RECORD: &str = "waymark.recovery";

/// Writes everything readable of `input` to the new file `output`, which must not exist. Ids, order, times,
/// metadata, attachments and compression stay; whole messages of a cut last chunk are kept on trust. Messages
/// whose channel was declared in a damaged chunk are kept when the summary repeats the declaration.
pub fn recover(
    input: &Path,
    output: &Path,
    options: &WriterOptions,
) -> Result<RecoverReport, RecordingError> {
    let outline = Outline::read(input)?;
    let mut walk = Walk::open(input, CutChunk::Salvage)?;
    walk.predeclare(&outline.summary);
    let file = File::create_new(output).map_err(RecordingError::io("cannot create", output))?;
    let mut report = RecoverReport {
        input: input.to_owned(),
        output: output.to_owned(),
        messages: 0,
        chunks: 0,
        faults: Vec::new(),
        cut_bytes: outline.cut_bytes,
    };
    let outcome = Copying::begin(&file, options, &outline)
        .and_then(|copying| copying.copy(&mut walk, &mut report))
        .and_then(|()| file.sync_all().map_err(RecordingError::io("cannot sync", output)));
    if let Err(error) = outcome {
        // Half a recovery is worth nothing, the input is still there.
        let _ = fs::remove_file(output);
        return Err(error);
    }
    Ok(report)
}

/// What must be known of a file before it is copied.
struct Outline {
    /// Of the first chunk; `None` when the file has no chunk.
    compression: Option<String>,
    /// The summary section's records.
    summary: Vec<Record<'static>>,
    /// Bytes behind the last whole record, if the file is cut before the end of its data.
    cut_bytes: u64,
}

impl Outline {
    fn read(path: &Path) -> Result<Self, RecordingError> {
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

type Output<'a> = mcap::Writer<NoSeek<BufWriter<&'a File>>>;

struct Copying<'a> {
    mcap: Output<'a>,
    declared: BTreeSet<u16>,
    /// Behind the data section everything repeats what came before, and the writer writes its own.
    after_data: bool,
    /// The recorder's accounts, which are only true of the whole file.
    accounts: Option<Metadata>,
}

impl<'a> Copying<'a> {
    fn begin(file: &'a File, options: &WriterOptions, outline: &Outline) -> Result<Self, RecordingError> {
        let mcap = mcap::WriteOptions::new()
            .profile("")
            .library(&options.library)
            .compression(outline.compression(options.compression).as_mcap())
            .compression_threads(0)
            .chunk_size(Some(options.chunk_bytes as u64))
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::new(file)))?;
        Ok(Self { mcap, declared: BTreeSet::new(), after_data: false, accounts: None })
    }

    fn copy(
        mut self,
        walk: &mut Walk<impl std::io::Read>,
        report: &mut RecoverReport,
    ) -> Result<(), RecordingError> {
        while let Some((offset, step)) = walk.next_step()? {
            match step {
                Step::Chunk(_) => report.chunks += 1,
                Step::Message(message) => {
                    self.message(&message)?;
                    report.messages += 1;
                }
                Step::Record(record) => self.record(record)?,
                Step::Fault(kind) => {
                    let chunk_lost = matches!(kind, FaultKind::Chunk(_));
                    report.chunks = report.chunks.saturating_sub(u64::from(chunk_lost));
                    report.faults.push(Fault { offset, kind });
                }
            }
        }
        match self.accounts.take() {
            Some(accounts) if report.faults.is_empty() => self.mcap.write_metadata(&accounts)?,
            _ => self.mcap.write_metadata(&report.to_metadata())?,
        }
        Ok(self.mcap.finish().map(drop)?)
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

#[cfg(test)]
mod tests;
