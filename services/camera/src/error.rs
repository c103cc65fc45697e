//! Why a camera does not run.

/// Why a camera does not run, or ends early.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// An id in the configuration is none.
    #[error("configuration: {0}")]
    Id(#[from] waymark_proto::keys::InvalidId),
    /// The source is named in a way that is not understood.
    #[error("source: {0}")]
    Source(#[from] ingest::source::SourceUriError),
    /// The simulator does not take these parameters.
    #[error("source: {0}")]
    Simulator(#[from] simulator::OptionsError),
    /// The pictures cannot be opened.
    #[error("source: {0}")]
    Pictures(#[from] ingest::pictures::OpenPicturesError),
    /// The film cannot be read.
    #[error("source: {0}")]
    Film(#[from] ingest::films::FilmError),
    /// A picture cannot be decoded, which sending it as video needs.
    #[error("source: {0}")]
    Decode(#[from] ingest::camera_decoder::Undecoded),
    /// A picture cannot be encoded as video.
    #[error(transparent)]
    Video(#[from] video::VideoError),
    /// A picture cannot be read.
    #[error(transparent)]
    ReadPicture(#[from] ingest::pictures::ReadPictureError),
    /// The recording cannot be read.
    #[error("source: {0}")]
    Recording(#[from] recording::RecordingError),
    /// A source that is a camera on Zenoh already.
    #[error("source `{0}` is a camera on Zenoh already; subscribe to it instead")]
    AlreadyPublished(String),
    /// A number out of its range.
    #[error("{name} is {value}; allowed are {allowed}")]
    OutOfRange {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A rendered picture cannot be encoded.
    #[error(transparent)]
    Encode(#[from] vision::frame::encode::EncodeError),
    /// The thread that reads the source panicked.
    #[error("the source failed unexpectedly")]
    SourceThread(#[from] tokio::task::JoinError),
    /// Zenoh refused.
    #[error("{doing} failed; `waymark router` must be reachable and its access control must allow it")]
    Zenoh {
        /// What was tried.
        doing: &'static str,
        /// What Zenoh says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl CameraError {
    pub(crate) fn zenoh(doing: &'static str) -> impl FnOnce(zenoh::Error) -> Self {
        move |source| Self::Zenoh { doing, source }
    }
}
