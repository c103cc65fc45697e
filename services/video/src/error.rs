//! Why video does not become pictures, or pictures video.

use vision::frame::decode::DecodeLimits;

/// Why video does not become pictures, or pictures video.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// A stream that claims larger pictures than allowed.
    #[error(
        "H.264 stream claims {width}×{height} pixels; at most {} a side and {} in all are allowed",
        limits.max_side_px, limits.max_pixels
    )]
    TooLarge {
        /// Claimed columns.
        width: u32,
        /// Claimed rows.
        height: u32,
        /// What is allowed.
        limits: DecodeLimits,
    },
    /// A stream that is valid but of a kind that is not decoded here.
    #[error("H.264 stream has {what}; {allowed}")]
    Unsupported {
        /// What it has.
        what: String,
        /// What can be decoded.
        allowed: &'static str,
    },
    /// Bytes that contradict the format.
    #[error("H.264 stream is damaged: {0}")]
    Damaged(String),
    /// The codec did not start.
    #[error("the H.264 codec did not start: {0}")]
    Codec(String),
    /// A picture that cannot be encoded.
    #[error(
        "{width}×{height} pixels cannot be encoded as H.264; allowed are 16×16 to 3840×2160 (or 2160×3840)"
    )]
    NotEncodable {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The encoder refused a picture.
    #[error("a picture could not be encoded as H.264: {0}")]
    Encode(String),
    /// A file that is no usable film.
    #[error("film cannot be read: {0}")]
    Film(String),
    /// A film cannot be written.
    #[error("film cannot be written: {0}")]
    Muxer(String),
    /// The file itself.
    #[error("film cannot be read or written")]
    Io(#[from] std::io::Error),
}

impl VideoError {
    pub(crate) fn damaged(reason: impl std::fmt::Display) -> Self {
        Self::Damaged(reason.to_string())
    }
}
