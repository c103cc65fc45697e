//! From bytes to a [`Frame`]: JPEG, PNG and raw pixels, refused from the header when they claim too much.
//!
//! Nothing is allocated before the claimed size has passed [`DecodeLimits`], and a picture that ends early is an
//! error, never a frame whose lower half is grey: a landmark must not go missing because bytes did.

mod jpeg;
mod png;
mod raw;

use std::fmt;

pub use raw::{RawEncoding, RawPicture};

use super::Frame;

/// How large a picture may claim to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecodeLimits {
    /// Largest width and largest height in pixels.
    pub max_side_px: u32,
    /// Largest number of pixels in all.
    pub max_pixels: u64,
}

impl Default for DecodeLimits {
    /// Sides up to 8,192 px and 2²⁴ pixels in all: 4096×4096, or 8 K wide panoramas, in 48 MiB of RGB.
    fn default() -> Self {
        Self { max_side_px: 8_192, max_pixels: 1 << 24 }
    }
}

/// The picture formats that [`decode`] understands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PictureFormat {
    /// JPEG (ITU-T T.81), baseline or progressive.
    Jpeg,
    /// PNG, every colour type and bit depth; an alpha channel is ignored.
    Png,
    /// Uncompressed pixels.
    Raw,
}

impl fmt::Display for PictureFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Jpeg => "JPEG",
            Self::Png => "PNG",
            Self::Raw => "raw",
        })
    }
}

/// Why bytes did not become a frame.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The first bytes are those of no known format.
    #[error(
        "a picture that starts with the bytes {start:02x?} is neither JPEG (ff d8 ff) nor PNG (89 50 4e 47); send one of these"
    )]
    UnknownFormat {
        /// Up to eight bytes from the start.
        start: Vec<u8>,
    },
    /// The header claims more pixels than allowed.
    #[error("{format} picture claims {width}×{height} pixels; at most {max_side_px} a side and {max_pixels} in all are allowed", max_side_px = limits.max_side_px, max_pixels = limits.max_pixels)]
    TooLarge {
        /// Format of the picture.
        format: PictureFormat,
        /// Claimed columns.
        width: u32,
        /// Claimed rows.
        height: u32,
        /// What is allowed.
        limits: DecodeLimits,
    },
    /// The header claims a picture without pixels.
    #[error("{format} picture claims {width}×{height} pixels; both must be at least 1")]
    Empty {
        /// Format of the picture.
        format: PictureFormat,
        /// Claimed columns.
        width: u32,
        /// Claimed rows.
        height: u32,
    },
    /// The header claims more pixels than that many bytes can hold.
    #[error(
        "{format} picture of {bytes} bytes claims {width}×{height} pixels, more than so few bytes can hold"
    )]
    Implausible {
        /// Format of the picture.
        format: PictureFormat,
        /// Length of the whole picture.
        bytes: usize,
        /// Claimed columns.
        width: u32,
        /// Claimed rows.
        height: u32,
    },
    /// The bytes end before the picture does.
    #[error("{format} picture ends early, after {bytes} bytes")]
    Truncated {
        /// Format of the picture.
        format: PictureFormat,
        /// Bytes received.
        bytes: usize,
    },
    /// The bytes contradict the format.
    #[error("{format} picture is damaged: {reason}")]
    Malformed {
        /// Format of the picture.
        format: PictureFormat,
        /// What the decoder stumbled over.
        reason: String,
    },
    /// A raw picture's name of pixel layout is unknown.
    #[error("raw picture encoding {got:?} is unknown; use one of rgb8, bgr8, rgba8, bgra8, mono8")]
    UnknownEncoding {
        /// The name received.
        got: String,
    },
    /// A raw picture's row is shorter than its pixels.
    #[error("raw picture has a row step of {step} bytes; {width} pixels of {encoding} need at least {want}")]
    StepTooSmall {
        /// Row step received, bytes.
        step: u32,
        /// Columns.
        width: u32,
        /// Pixel layout.
        encoding: RawEncoding,
        /// Bytes that one row's pixels take.
        want: u64,
    },
}

/// The format that the first bytes announce, `None` for anything else than JPEG and PNG.
#[must_use]
pub fn sniff(bytes: &[u8]) -> Option<PictureFormat> {
    match bytes {
        [0xff, 0xd8, 0xff, ..] => Some(PictureFormat::Jpeg),
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', ..] => Some(PictureFormat::Png),
        _ => None,
    }
}

/// Decodes a JPEG or PNG picture, whichever its first bytes announce.
///
/// # Errors
/// See [`DecodeError`]; in particular a picture that ends early is refused.
pub fn decode(bytes: &[u8], limits: &DecodeLimits) -> Result<Frame, DecodeError> {
    decode_into(bytes, limits, Vec::new())
}

/// As [`decode`], in the pixel storage of an earlier frame (see [`Frame::into_rgb`]), whose content is lost.
///
/// # Errors
/// As [`decode`]; the storage is freed then.
pub fn decode_into(bytes: &[u8], limits: &DecodeLimits, storage: Vec<u8>) -> Result<Frame, DecodeError> {
    match sniff(bytes) {
        Some(PictureFormat::Jpeg) => jpeg::decode(bytes, limits, storage),
        Some(PictureFormat::Png) => png::decode(bytes, limits),
        _ => Err(DecodeError::UnknownFormat { start: bytes[..bytes.len().min(8)].to_vec() }),
    }
}

/// Converts uncompressed pixels.
///
/// # Errors
/// When the claimed size breaks `limits`, the row step is too short, or bytes are missing.
pub fn decode_raw(
    picture: RawPicture<'_>,
    limits: &DecodeLimits,
    storage: Vec<u8>,
) -> Result<Frame, DecodeError> {
    raw::decode(picture, limits, storage)
}

impl DecodeLimits {
    fn check(&self, format: PictureFormat, width: u32, height: u32) -> Result<(), DecodeError> {
        if width == 0 || height == 0 {
            return Err(DecodeError::Empty { format, width, height });
        }
        let pixels = u64::from(width) * u64::from(height);
        if width.max(height) > self.max_side_px || pixels > self.max_pixels {
            return Err(DecodeError::TooLarge { format, width, height, limits: *self });
        }
        Ok(())
    }
}

/// A frame of `rgb`, which the decoder sized for it.
fn frame(format: PictureFormat, width: u32, height: u32, rgb: Vec<u8>) -> Result<Frame, DecodeError> {
    Frame::from_rgb(width, height, rgb)
        .map_err(|error| DecodeError::Malformed { format, reason: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::encode::{Quality, encode_jpeg, encode_png};
    use proptest::prelude::*;

    fn gradient(width: u32, height: u32) -> Frame {
        let rgb = (0..height)
            .flat_map(|y| {
                (0..width).flat_map(move |x| [(x * 2) as u8, (y * 2) as u8, ((x * 7) ^ (y * 3)) as u8])
            })
            .collect();
        Frame::from_rgb(width, height, rgb).unwrap()
    }

    #[test]
    fn what_is_neither_jpeg_nor_png_is_named() {
        let error = decode(b"GIF89a trailing", &DecodeLimits::default()).unwrap_err();
        assert_eq!(error, DecodeError::UnknownFormat { start: b"GIF89a t".to_vec() });
        assert!(decode(&[], &DecodeLimits::default()).is_err());
    }

    #[test]
    fn storage_of_any_size_is_used_again() {
        let limits = DecodeLimits::default();
        for original in [gradient(64, 48), gradient(20, 10), gradient(90, 70)] {
            let png = encode_png(&original).unwrap();
            let reused = decode_into(&png, &limits, gradient(33, 77).into_rgb()).unwrap();
            assert_eq!(reused, original);
        }
    }

    proptest! {
        #[test]
        fn random_bytes_never_panic(mut bytes in proptest::collection::vec(any::<u8>(), 0..600), kind in 0..3_u8) {
            let start: &[u8] = match kind {
                0 => &[0xff, 0xd8, 0xff],
                1 => &[0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'],
                _ => &[],
            };
            bytes.splice(0..0, start.iter().copied());
            let _ = decode(&bytes, &DecodeLimits::default());
        }

        #[test]
        fn mutated_pictures_never_panic(at in 0.0..1.0_f64, value: u8, cut in 0.0..1.0_f64, png: bool) {
            let original = gradient(70, 50);
            let mut bytes = match png {
                true => encode_png(&original).unwrap(),
                false => encode_jpeg(&original, Quality::default()).unwrap(),
            };
            let position = (at * bytes.len() as f64) as usize;
            bytes[position] = value;
            let _ = decode(&bytes, &DecodeLimits::default());
            bytes.truncate((cut * bytes.len() as f64) as usize);
            let _ = decode(&bytes, &DecodeLimits::default());
        }
    }
}
