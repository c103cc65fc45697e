//! What a leader knows from its earlier starts: how many there were, and the set as it was last.

use runtime::StateDir;
use vision::LandmarkSet;
use waymark_proto::json::{set_from_json, set_to_json};

use crate::book::Book;
use crate::error::LeaderError;

const EPOCH_FILE: &str = "epoch";
const SET_FILE: &str = "landmarks.json";

/// A leader's state directory.
pub(crate) struct Memory {
    state: StateDir,
}

impl Memory {
    pub(crate) fn in_directory(state: StateDir) -> Self {
        Self { state }
    }

    /// The set as it was left, in an epoch above all earlier ones. The new epoch is on disk before anything is
    /// published in it.
    pub(crate) fn reopen(&self) -> Result<Book, LeaderError> {
        let left_behind = self.landmarks()?;
        // Either file may have been lost; the greater of the two still rises.
        let epoch = self.epoch()?.max(left_behind.version.epoch).saturating_add(1);
        self.state
            .replace(EPOCH_FILE, epoch.to_string().as_bytes())
            .map_err(|source| self.unusable(EPOCH_FILE, &source))?;
        Ok(Book::reopened(epoch, left_behind.landmarks))
    }

    /// Keeps the set for the next start.
    pub(crate) fn keep(&self, set: &LandmarkSet) -> Result<(), LeaderError> {
        let text = set_to_json(set).map_err(|source| self.unusable(SET_FILE, &source))?;
        self.state.replace(SET_FILE, text.as_bytes()).map_err(|source| self.unusable(SET_FILE, &source))
    }

    fn epoch(&self) -> Result<u64, LeaderError> {
        match self.text(EPOCH_FILE)? {
            None => Ok(0),
            Some(text) => text.trim().parse().map_err(|error| self.unusable(EPOCH_FILE, &error)),
        }
    }

    fn landmarks(&self) -> Result<LandmarkSet, LeaderError> {
        match self.text(SET_FILE)? {
            None => Ok(LandmarkSet::default()),
            Some(text) => set_from_json(&text).map_err(|error| self.unusable(SET_FILE, &error)),
        }
    }

    fn text(&self, name: &str) -> Result<Option<String>, LeaderError> {
        let bytes = self.state.read(name).map_err(|error| self.unusable(name, &error))?;
        bytes.map(String::from_utf8).transpose().map_err(|error| self.unusable(name, &error))
    }

    fn unusable(&self, name: &str, reason: &dyn std::error::Error) -> LeaderError {
        LeaderError::Memory { path: self.state.path().join(name), reason: reason.to_string() }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn memory(place: &tempfile::TempDir) -> Memory {
        Memory::in_directory(StateDir::open(place.path()).unwrap())
    }

    #[test]
    fn the_epoch_rises_at_every_start_and_never_returns() {
        let place = tempfile::tempdir().unwrap();
        let epoch = || memory(&place).reopen().unwrap().set().version.epoch;
        assert_eq!((epoch(), epoch()), (1, 2));
        let memory = memory(&place);
        let set = memory.reopen().unwrap().set();
        memory.keep(&set).unwrap();
        fs::remove_file(place.path().join(EPOCH_FILE)).unwrap();
        drop(memory);
        assert_eq!(epoch(), set.version.epoch + 1);
    }

    #[test]
    fn damaged_files_are_named_rather_than_overwritten() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join(EPOCH_FILE), "soon").unwrap();
        let error = memory(&place).reopen().unwrap_err().to_string();
        assert!(error.contains("epoch") && error.contains("move it away"), "{error}");
        assert_eq!(fs::read_to_string(place.path().join(EPOCH_FILE)).unwrap(), "soon");
    }
}
