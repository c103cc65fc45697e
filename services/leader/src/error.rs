//! Why a leader cannot start, or a landmark file cannot be used.

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

use http_face::TokenError;
use runtime::identity::StateDirError;
use runtime::presence::PresenceError;
use waymark_proto::json::LandmarkFileError;
use waymark_proto::keys::InvalidId;

use crate::book::RefusedEdit;

/// Why a leader cannot start.
#[derive(Debug, thiserror::Error)]
pub enum LeaderError {
    /// A fleet's or vehicle's id is none.
    #[error(transparent)]
    Id(#[from] InvalidId),
    /// The state directory cannot be used.
    #[error(transparent)]
    State(#[from] StateDirError),
    /// A file in the state directory cannot be used.
    #[error("{path}: {reason}; move it away to begin with a fresh one")]
    Memory {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A landmark file cannot be used.
    #[error(transparent)]
    Landmarks(#[from] LandmarkFilesError),
    /// The landmark files contradict each other.
    #[error("the landmark files: {0}")]
    Edit(#[from] RefusedEdit),
    /// Another leader serves this vehicle.
    #[error(transparent)]
    Presence(#[from] PresenceError),
    /// The web face's address is taken.
    #[error("cannot listen on {address}: {source}; choose another with http.listen")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// A camera's thread cannot be started.
    #[error("no thread for camera {camera}: {source}")]
    Thread {
        /// The camera's id.
        camera: String,
        /// What the system says.
        source: io::Error,
    },
    /// The token file cannot be used.
    #[error(transparent)]
    Token(#[from] TokenError),
    /// Zenoh refused something that a leader needs.
    #[error("{what}: {reason}")]
    Zenoh {
        /// What was tried.
        what: &'static str,
        /// Zenoh's words.
        reason: zenoh::Error,
    },
}

impl LeaderError {
    pub(crate) fn zenoh(what: &'static str) -> impl FnOnce(zenoh::Error) -> Self {
        move |reason| Self::Zenoh { what, reason }
    }
}

/// Why landmark files cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum LandmarkFilesError {
    /// A file or directory cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file holds no landmark.
    #[error("{path}: {source}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<LandmarkFileError>,
    },
    /// A directory holds no landmark file.
    #[error("there is no *.json in {path}; write one with `waymark landmark learn … -o FILE`")]
    Empty {
        /// The directory.
        path: PathBuf,
    },
}
