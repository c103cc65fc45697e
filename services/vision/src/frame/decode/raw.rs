//! Uncompressed pixels, as `foxglove.RawImage` and ROS's `sensor_msgs/Image` carry them.

use std::fmt;
use std::str::FromStr;

use super::{DecodeError, DecodeLimits, Frame, PictureFormat};

/// The order of samples in one pixel, eight bits each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RawEncoding {
    /// R, G, B.
    Rgb8,
    /// B, G, R.
    Bgr8,
    /// R, G, B and an ignored alpha.
    Rgba8,
    /// B, G, R and an ignored alpha.
    Bgra8,
    /// One grey level.
    Mono8,
}

impl RawEncoding {
    /// Every encoding.
    pub const ALL: [Self; 5] = [Self::Rgb8, Self::Bgr8, Self::Rgba8, Self::Bgra8, Self::Mono8];

    /// The name on the wire.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rgb8 => "rgb8",
            Self::Bgr8 => "bgr8",
            Self::Rgba8 => "rgba8",
            Self::Bgra8 => "bgra8",
            Self::Mono8 => "mono8",
        }
    }

    const fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Mono8 => 1,
            Self::Rgb8 | Self::Bgr8 => 3,
            Self::Rgba8 | Self::Bgra8 => 4,
        }
    }
}

impl fmt::Display for RawEncoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for RawEncoding {
    type Err = DecodeError;

    fn from_str(name: &str) -> Result<Self, DecodeError> {
        Self::ALL
            .into_iter()
            .find(|encoding| encoding.name() == name)
            .ok_or_else(|| DecodeError::UnknownEncoding { got: name.chars().take(32).collect() })
    }
}

/// A picture of uncompressed pixels; rows may be padded.
#[derive(Clone, Copy, Debug)]
pub struct RawPicture<'a> {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Order of samples in one pixel.
    pub encoding: RawEncoding,
    /// Bytes from the start of one row to the start of the next.
    pub step: u32,
    /// The rows from the top; padding after the last row may be missing.
    pub data: &'a [u8],
}

pub(super) fn decode(
    picture: RawPicture<'_>,
    limits: &DecodeLimits,
    mut storage: Vec<u8>,
) -> Result<Frame, DecodeError> {
    let RawPicture { width, height, encoding, step, data } = picture;
    limits.check(PictureFormat::Raw, width, height)?;
    let row_bytes = width as usize * encoding.bytes_per_pixel();
    if (step as usize) < row_bytes {
        return Err(DecodeError::StepTooSmall { step, width, encoding, want: row_bytes as u64 });
    }
    let needed = u64::from(step) * u64::from(height - 1) + row_bytes as u64;
    if (data.len() as u64) < needed {
        return Err(DecodeError::Truncated { format: PictureFormat::Raw, bytes: data.len() });
    }
    storage.clear();
    storage.reserve(3 * width as usize * height as usize);
    for row in data.chunks(step as usize).take(height as usize) {
        append_rgb(&row[..row_bytes], encoding, &mut storage);
    }
    super::frame(PictureFormat::Raw, width, height, storage)
}

fn append_rgb(row: &[u8], encoding: RawEncoding, rgb: &mut Vec<u8>) {
    match encoding {
        RawEncoding::Rgb8 => rgb.extend_from_slice(row),
        RawEncoding::Bgr8 => rgb.extend(row.as_chunks().0.iter().flat_map(|&[b, g, r]| [r, g, b])),
        RawEncoding::Rgba8 => rgb.extend(row.as_chunks().0.iter().flat_map(|&[r, g, b, _]| [r, g, b])),
        RawEncoding::Bgra8 => rgb.extend(row.as_chunks().0.iter().flat_map(|&[b, g, r, _]| [r, g, b])),
        RawEncoding::Mono8 => rgb.extend(row.iter().flat_map(|&level| [level; 3])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(encoding: RawEncoding, step: u32, data: &[u8]) -> Result<Frame, DecodeError> {
        let picture = RawPicture { width: 2, height: 2, encoding, step, data };
        super::super::decode_raw(picture, &DecodeLimits::default(), vec![9; 100])
    }

    #[test]
    fn every_encoding_and_padding_becomes_rgb() {
        let rgb = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
        let padded = [1, 2, 3, 4, 5, 6, 0, 0, 7, 8, 9, 10, 11, 12];
        assert_eq!(decoded(RawEncoding::Rgb8, 6, &rgb).unwrap().rgb(), rgb);
        assert_eq!(decoded(RawEncoding::Rgb8, 8, &padded).unwrap().rgb(), rgb);
        let swapped = [3, 2, 1, 6, 5, 4, 9, 8, 7, 12, 11, 10];
        assert_eq!(decoded(RawEncoding::Bgr8, 6, &swapped).unwrap().rgb(), rgb);
        let alpha = [3, 2, 1, 0, 6, 5, 4, 0, 9, 8, 7, 0, 12, 11, 10, 0];
        assert_eq!(decoded(RawEncoding::Bgra8, 8, &alpha).unwrap().rgb(), rgb);
        let grey = decoded(RawEncoding::Mono8, 3, &[5, 6, 0, 7, 8]).unwrap();
        assert_eq!(grey.rgb(), [5, 5, 5, 6, 6, 6, 7, 7, 7, 8, 8, 8]);
    }

    #[test]
    fn what_does_not_add_up_is_refused() {
        let short = decoded(RawEncoding::Rgb8, 6, &[0; 11]).unwrap_err();
        assert_eq!(short, DecodeError::Truncated { format: PictureFormat::Raw, bytes: 11 });
        let step = decoded(RawEncoding::Rgba8, 6, &[0; 100]).unwrap_err();
        assert!(step.to_string().contains("row step of 6"), "{step}");
        assert!("yuv422".parse::<RawEncoding>().unwrap_err().to_string().contains("yuv422"));
        for encoding in RawEncoding::ALL {
            assert_eq!(encoding.name().parse(), Ok(encoding));
        }
    }

    #[test]
    fn a_claim_of_too_many_pixels_is_refused_without_looking_at_the_data() {
        let encoding = RawEncoding::Rgb8;
        let picture = RawPicture { width: u32::MAX, height: u32::MAX, encoding, step: u32::MAX, data: &[] };
        let error = super::super::decode_raw(picture, &DecodeLimits::default(), Vec::new()).unwrap_err();
        assert!(matches!(error, DecodeError::TooLarge { .. }), "{error}");
    }
}
