//! Why a follower ends early.

use std::path::PathBuf;

/// Why a follower does not run.
#[derive(Debug, thiserror::Error)]
pub enum FollowerError {
    /// An id in the configuration is none.
    #[error("configuration: {0}")]
    Id(#[from] waymark_proto::keys::InvalidId),
    /// Zenoh refused.
    #[error("{doing} failed; `waymark router` must be reachable and its access control must allow it")]
    Zenoh {
        /// What was tried.
        doing: &'static str,
        /// What Zenoh says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The accepted set on disk is damaged.
    #[error("{path} does not hold a landmark set; delete it to begin without landmarks")]
    DamagedSet {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The state directory does not do.
    #[error("{path}: give a `state_dir` that can be written")]
    State {
        /// The file or directory.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The state directory is in use or cannot be made.
    #[error(transparent)]
    StateDir(#[from] runtime::identity::StateDirError),
    /// The recorder does not start.
    #[error(transparent)]
    Recorder(#[from] recording::RecordingError),
    /// The token file does not do.
    #[error(transparent)]
    Token(#[from] http_face::TokenError),
    /// A camera's thread did not start.
    #[error("no thread for camera {camera}")]
    Thread {
        /// The camera.
        camera: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// Another instance of this vehicle is there.
    #[error(transparent)]
    Presence(#[from] runtime::presence::PresenceError),
    /// The web face cannot listen.
    #[error("http.listen = {address} cannot be bound; choose another port")]
    Listen {
        /// The address.
        address: std::net::SocketAddr,
        /// What the system says.
        source: std::io::Error,
    },
}

impl FollowerError {
    pub(crate) fn zenoh(doing: &'static str) -> impl FnOnce(zenoh::Error) -> Self {
        move |source| Self::Zenoh { doing, source }
    }
}
