//! Recovery: a new, valid file with everything that can be read of a cut or damaged one.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::BufWriter,
    path::{Path, PathBuf},
};

use mcap::{
    records::{MessageHeader, Record},
    write::NoSeek,
};

use crate::{
    RecordingError, WriterOptions,
    file_name::{ACTIVE, FINISHED},
    storage::rename_new,
    walk::{CutChunk, Fault, FaultKind, RecordedMessage, Step, Walk},
};

/// Extension of a file that recovery is writing.
const RECOVERING: &str = ".recovering";

/// Extension of the original when recovery had to leave out more than a cut end.
const DAMAGED: &str = ".damaged";

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
    /// Bytes of the input behind its last whole record.
    pub cut_bytes: u64,
}

impl RecoverReport {
    /// Whether something that was in the file is not in the new one.
    pub fn lost_data(&self) -> bool {
        self.cut_bytes > 0 || self.faults.iter().any(|fault| fault.kind != FaultKind::Cut)
    }
}

/// Writes everything readable of `input` to the new file `output`, which must not exist. Ids, order, times,
/// metadata and attachments stay; whole messages of a cut last chunk are kept on trust.
pub fn recover(
    input: &Path,
    output: &Path,
    options: &WriterOptions,
) -> Result<RecoverReport, RecordingError> {
    let mut walk = Walk::open(input, CutChunk::Salvage)?;
    let file = File::create_new(output).map_err(RecordingError::io("cannot create", output))?;
    let outcome = copy(&mut walk, &file, options).and_then(|mut report| {
        file.sync_all().map_err(RecordingError::io("cannot sync", output))?;
        let input_bytes =
            fs::metadata(input).map_err(RecordingError::io("cannot read the size of", input))?.len();
        let cut = report.faults.iter().find(|fault| fault.kind == FaultKind::Cut);
        report.cut_bytes = cut.map_or(0, |fault| input_bytes.saturating_sub(fault.offset));
        Ok(RecoverReport { input: input.to_owned(), output: output.to_owned(), ..report })
    });
    if outcome.is_err() {
        // Half a recovery is worth nothing, the input is still there.
        let _ = fs::remove_file(output);
    }
    outcome
}

type Output<'a> = mcap::Writer<NoSeek<BufWriter<&'a File>>>;

fn copy(
    walk: &mut Walk<impl std::io::Read>,
    file: &File,
    options: &WriterOptions,
) -> Result<RecoverReport, RecordingError> {
    let mut copying = Copying {
        mcap: mcap::WriteOptions::new()
            .profile("")
            .library(&options.library)
            .compression(options.compression.as_mcap())
            .compression_threads(0)
            .chunk_size(Some(options.chunk_bytes as u64))
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::new(file)))?,
        declared: BTreeSet::new(),
        after_data: false,
    };
    let mut report = RecoverReport {
        input: PathBuf::new(),
        output: PathBuf::new(),
        messages: 0,
        chunks: 0,
        faults: Vec::new(),
        cut_bytes: 0,
    };
    while let Some((offset, step)) = walk.next_step()? {
        match step {
            Step::Chunk(_) => report.chunks += 1,
            Step::Message(message) => {
                copying.message(&message)?;
                report.messages += 1;
            }
            Step::Record(record) => copying.record(&record)?,
            Step::Fault(kind) => {
                report.chunks -= u64::from(matches!(kind, FaultKind::Chunk(_))).min(report.chunks);
                report.faults.push(Fault { offset, kind });
            }
        }
    }
    copying.mcap.finish()?;
    Ok(report)
}

struct Copying<'a> {
    mcap: Output<'a>,
    declared: BTreeSet<u16>,
    /// Behind the data section everything repeats what came before, and the writer writes its own.
    after_data: bool,
}

impl Copying<'_> {
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

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordingError> {
        match record {
            _ if self.after_data => {}
            Record::DataEnd(_) => self.after_data = true,
            Record::Metadata(metadata) => self.mcap.write_metadata(metadata)?,
            Record::Attachment { header, data, .. } => self.mcap.attach(&mcap::Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name.clone(),
                media_type: header.media_type.clone(),
                data: data.as_ref().into(),
            })?,
            _ => {}
        }
        Ok(())
    }
}

/// What start-up recovery did with one `.active` file.
#[derive(Debug)]
pub enum Leftover {
    /// It was complete: only its renaming was missing.
    Renamed(PathBuf),
    /// It was cut; the recovered file has its final name. The original is deleted, or kept as
    /// `NAME.mcap.damaged` when whole chunks of it were damaged.
    Recovered(RecoverReport),
    /// It could not be recovered and stays as it is.
    Left(PathBuf, RecordingError),
}

/// Recovers every `.active` file in `directory` whose writer is gone (no process holds its lock).
pub fn recover_directory(directory: &Path, options: &WriterOptions) -> Result<Vec<Leftover>, RecordingError> {
    let entries = match fs::read_dir(directory) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(RecordingError::io("cannot list", directory))?,
    };
    let mut by_extension: BTreeMap<&str, Vec<PathBuf>> = BTreeMap::new();
    for entry in entries {
        let path = entry.map_err(RecordingError::io("cannot list", directory))?.path();
        let name = path.to_string_lossy().into_owned();
        let extension = [RECOVERING, ACTIVE].into_iter().find(|extension| name.ends_with(extension));
        if let Some(extension) = extension {
            by_extension.entry(extension).or_default().push(path);
        }
    }
    for half_done in by_extension.remove(RECOVERING).unwrap_or_default() {
        fs::remove_file(&half_done).map_err(RecordingError::io("cannot delete", &half_done))?;
    }
    let mut actives = by_extension.remove(ACTIVE).unwrap_or_default();
    actives.sort();
    let abandoned = actives.into_iter().filter_map(|path| lock(&path).map(|lock| (path, lock)));
    Ok(abandoned
        .map(|(path, _lock)| {
            recover_leftover(&path, options).unwrap_or_else(|error| Leftover::Left(path, error))
        })
        .collect())
}

/// Locks the file unless its writer still does.
fn lock(path: &Path) -> Option<File> {
    let file = File::open(path).ok()?;
    file.try_lock().ok().map(|()| file)
}

fn recover_leftover(active: &Path, options: &WriterOptions) -> Result<Leftover, RecordingError> {
    let stem = active.to_string_lossy();
    let finished = PathBuf::from(format!("{}{FINISHED}", stem.strip_suffix(ACTIVE).unwrap_or(&stem)));
    if is_complete(active)? {
        rename_new(active, &finished).map_err(RecordingError::io("cannot rename", active))?;
        sync_directory_of(&finished)?;
        return Ok(Leftover::Renamed(finished));
    }
    let recovering = PathBuf::from(format!("{}{RECOVERING}", finished.display()));
    let report = recover(active, &recovering, options)?;
    rename_new(&recovering, &finished).map_err(RecordingError::io("cannot rename", &recovering))?;
    sync_directory_of(&finished)?;
    if report.faults.iter().all(|fault| fault.kind == FaultKind::Cut) {
        fs::remove_file(active).map_err(RecordingError::io("cannot delete", active))?;
    } else {
        // Somebody may know how to get more out of a damaged chunk.
        let damaged = PathBuf::from(format!("{}{DAMAGED}", finished.display()));
        rename_new(active, &damaged).map_err(RecordingError::io("cannot rename", active))?;
    }
    Ok(Leftover::Recovered(RecoverReport { output: finished, ..report }))
}

fn is_complete(path: &Path) -> Result<bool, RecordingError> {
    let mut walk = Walk::open(path, CutChunk::Skip)?;
    while let Some((_, step)) = walk.next_step()? {
        if matches!(step, Step::Fault(_)) {
            return Ok(false);
        }
    }
    Ok(true)
}

fn sync_directory_of(path: &Path) -> Result<(), RecordingError> {
    let directory = path.parent().unwrap_or(Path::new("."));
    let synced = File::open(directory).and_then(|directory| directory.sync_all());
    synced.map_err(RecordingError::io("cannot sync", directory))
}

#[cfg(test)]
mod tests;
