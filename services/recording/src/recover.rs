//! Recovery: a new, valid file with everything that can be read of a cut or damaged one.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::Read,
    path::{Path, PathBuf},
};

use mcap::records::Metadata;

use crate::{
    RecordingError, WriterOptions,
    copy::{Copying, Outline},
    walk::{CutChunk, Fault, FaultKind, Walk},
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

    pub(crate) fn begin(input: &Path, output: &Path, cut_bytes: u64) -> Self {
        let (input, output) = (input.to_owned(), output.to_owned());
        Self { input, output, messages: 0, chunks: 0, faults: Vec::new(), cut_bytes }
    }

    pub(crate) fn to_metadata(&self) -> Metadata {
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
    let mut report = RecoverReport::begin(input, output, outline.cut_bytes);
    let outcome = file
        .try_clone()
        .map_err(RecordingError::io("cannot open twice", output))
        .and_then(|copy| Copying::begin(copy, options, &outline))
        .and_then(|copying| copy_all(copying, &mut walk, &mut report))
        .and_then(|()| file.sync_all().map_err(RecordingError::io("cannot sync", output)));
    if let Err(error) = outcome {
        // Half a recovery is worth nothing, the input is still there.
        let _ = fs::remove_file(output);
        return Err(error);
    }
    Ok(report)
}

fn copy_all(
    mut copying: Copying,
    walk: &mut Walk<impl Read>,
    report: &mut RecoverReport,
) -> Result<(), RecordingError> {
    while copying.step(walk, report)?.is_some() {}
    copying.finish(report)
}

#[cfg(test)]
mod tests;
