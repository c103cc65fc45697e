//! The accepted landmark set on disk: what a follower begins with when its leader is gone.

use std::path::PathBuf;

use prost::Message;
use runtime::StateDir;
use waymark_proto::{convert, v1};

use crate::accepted::AcceptedSet;
use crate::error::FollowerError;

/// A file in the state directory that holds one `waymark.v1.LandmarkSet`.
pub(crate) struct SetFile {
    state: StateDir,
    name: String,
}

impl SetFile {
    /// The file of `leader`'s landmarks.
    pub(crate) fn new(state: StateDir, leader: &str) -> Self {
        Self { state, name: format!("landmarks-of-{leader}.binpb") }
    }

    /// The set on disk, empty when there is none.
    ///
    /// # Errors
    /// When the file cannot be read or holds something else.
    pub(crate) fn load(&self) -> Result<AcceptedSet, FollowerError> {
        let path = self.path();
        let bytes = match self.state.read(&self.name) {
            Ok(Some(bytes)) => bytes,
            Ok(None) => return Ok(AcceptedSet::default()),
            Err(source) => return Err(FollowerError::State { path, source }),
        };
        let message = v1::LandmarkSet::decode(bytes.as_slice()).map_err(|error| self.damaged(error))?;
        let set = convert::set_from_wire(&message).map_err(|error| self.damaged(error))?;
        Ok(AcceptedSet::restored(&set))
    }

    /// Puts `accepted` in place of what the file held.
    ///
    /// # Errors
    /// When the disk does not take it; the old content is then untouched.
    pub(crate) fn store(&self, accepted: &AcceptedSet) -> Result<(), FollowerError> {
        let bytes = convert::set_to_wire(&accepted.set()).encode_to_vec();
        self.state
            .replace(&self.name, &bytes)
            .map_err(|source| FollowerError::State { path: self.path(), source })
    }

    fn path(&self) -> PathBuf {
        self.state.path().join(&self.name)
    }

    fn damaged(&self, error: impl std::error::Error + Send + Sync + 'static) -> FollowerError {
        FollowerError::DamagedSet { path: self.path(), source: Box::new(error) }
    }
}
