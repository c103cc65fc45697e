//! Checks a recording: structure, CRCs, schemas, timestamps, losses.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::{
    RecordingError,
    scan::Scanner,
    walk::{CutChunk, Walk},
};

mod contents;
mod structure;
mod summary;
#[cfg(test)]
mod tests;

/// Findings of one kind beyond this many are only counted.
const MOST_PER_KIND: usize = 10;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing; nothing is wrong.
    Note,
    /// Readers cope, people may be surprised.
    Warning,
    /// Data that was offered is not in the file.
    Loss,
    /// The file breaks the MCAP specification or its own schemas.
    Error,
}

/// One thing the check noticed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// What part of the check found it.
    pub aspect: Aspect,
    /// Where in the file, bytes, when it has a place.
    pub offset: Option<u64>,
    /// What it is.
    pub message: String,
}

/// Parts of the check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Aspect {
    /// Records, chunks, footer.
    Structure,
    /// Checksums.
    Crc,
    /// Indexes and statistics against what is there.
    Summary,
    /// Schemas, and messages against them.
    Schema,
    /// Log and publish times.
    Time,
    /// Accounts and sequence numbers.
    Loss,
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Check {
    /// The file.
    pub path: PathBuf,
    /// Findings in the order of the file, at most ten of each aspect and severity.
    pub findings: Vec<Finding>,
    /// Further findings that are not listed.
    pub unlisted: u64,
}

/// The check in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing worse than a warning.
    Fine,
    /// A valid file that says, or shows, that data was lost.
    DataLost,
    /// The file is damaged.
    Damaged,
}

impl Check {
    /// The worst finding decides.
    pub fn verdict(&self) -> Verdict {
        match self.findings.iter().map(|finding| finding.severity).max() {
            Some(Severity::Error) => Verdict::Damaged,
            Some(Severity::Loss) => Verdict::DataLost,
            Some(Severity::Note | Severity::Warning) | None => Verdict::Fine,
        }
    }

    pub(crate) fn add(
        &mut self,
        severity: Severity,
        aspect: Aspect,
        offset: impl Into<Option<u64>>,
        message: String,
    ) {
        let alike = self.findings.iter().filter(|f| f.severity == severity && f.aspect == aspect).count();
        if alike < MOST_PER_KIND {
            self.findings.push(Finding { severity, aspect, offset: offset.into(), message });
        } else {
            self.unlisted += 1;
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = format!("{:?}", self.severity).to_lowercase();
        match self.offset {
            Some(offset) => write!(f, "{severity}: at byte {offset}: {}", self.message),
            None => write!(f, "{severity}: {}", self.message),
        }
    }
}

/// Checks `path` by reading all of it twice: record by record for the structure, and message by message.
pub fn check(path: &Path) -> Result<Check, RecordingError> {
    let mut check = Check { path: path.to_owned(), findings: Vec::new(), unlisted: 0 };
    structure::check(&mut Scanner::open(path)?, &mut check)
        .map_err(RecordingError::io("cannot read", path))?;
    contents::check(&mut Walk::open(path, CutChunk::Skip)?, &mut check)?;
    Ok(check)
}
