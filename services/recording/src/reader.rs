//! Messages of a recording, in file order, of complete, cut and damaged files.

use std::{fs::File, io::BufReader, path::Path};

use crate::{
    RecordingError,
    walk::{CutChunk, Fault, RecordedMessage, Step, Walk},
};

/// What to do about faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strictness {
    /// The first fault is an error, a missing footer included.
    Strict,
    /// Faults are stepped over and kept for [`MessageReader::faults`]; a file that is still being written
    /// reads to its last whole chunk.
    Lenient,
}

/// An iterator over a recording's messages. Memory is bounded by the largest chunk.
pub struct MessageReader {
    walk: Walk<BufReader<File>>,
    path: std::path::PathBuf,
    strictness: Strictness,
    faults: Vec<Fault>,
    ended: bool,
}

impl MessageReader {
    /// Opens `path`; fails when it is no MCAP file.
    pub fn open(path: &Path, strictness: Strictness) -> Result<Self, RecordingError> {
        let walk = Walk::open(path, CutChunk::Skip)?;
        Ok(Self { walk, path: path.to_owned(), strictness, faults: Vec::new(), ended: false })
    }

    /// Faults stepped over so far.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    fn next_message(&mut self) -> Result<Option<RecordedMessage>, RecordingError> {
        while let Some((offset, step)) = self.walk.next_step()? {
            match (step, self.strictness) {
                (Step::Message(message), _) => return Ok(Some(message)),
                (Step::Fault(kind), Strictness::Lenient) => self.faults.push(Fault { offset, kind }),
                (Step::Fault(kind), Strictness::Strict) => {
                    let fault = kind.to_string();
                    return Err(RecordingError::Damaged { path: self.path.clone(), offset, fault });
                }
                (Step::Chunk(_) | Step::Record(_), _) => {}
            }
        }
        Ok(None)
    }
}

impl Iterator for MessageReader {
    type Item = Result<RecordedMessage, RecordingError>;

    /// Nothing follows an error.
    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.next_message().transpose();
        self.ended = !matches!(next, Some(Ok(_)));
        next
    }
}
