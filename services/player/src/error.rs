//! Why a recording is not played.

use recording::RecordingError;

/// Why a recording is not played, or not to its end.
#[derive(Debug, thiserror::Error)]
pub enum PlayError {
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// There is nothing to play.
    #[error(
        "none of the recordings holds a message with a key; messages of foreign recordings are published by their topic"
    )]
    Nothing,
    /// A key that Zenoh does not take.
    #[error(
        "`{key}` is no key to publish under; use --remap FROM=TO with a TO of non-empty chunks between slashes, without wildcards"
    )]
    Key {
        /// The key.
        key: String,
        /// What Zenoh says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The operating system gave no thread.
    #[error("cannot start a thread")]
    Thread(#[from] std::io::Error),
    /// A rate that is none.
    #[error("rate is {0}; allowed are 0.01 to 1000, or 0 for as fast as possible")]
    Rate(f64),
    /// A remapping that is none.
    #[error(
        "`{0}` is no remapping; write FROM=TO, where FROM begins a key, as in waymark/v1/convoy/a=waymark/v1/convoy/b"
    )]
    Remap(String),
    /// The thread that plays panicked.
    #[error("the player failed unexpectedly")]
    Panicked,
}
