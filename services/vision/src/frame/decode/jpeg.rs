//! JPEG (ITU-T T.81).
//!
//! A picture that was cut off is refused. Entropy-coded data carries no checksum, so bytes lost in the middle are
//! noticed only when they break the code or a marker.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::{DecodeError, DecodeLimits, Frame, PictureFormat};

const FORMAT: PictureFormat = PictureFormat::Jpeg;

/// An 8×8 block takes at least one bit; the widest sampling that T.81 allows spreads eight blocks over 1,024 pixels,
/// so no byte of a JPEG stands for more pixels than this.
const MAX_PIXELS_PER_BYTE: u64 = 1_024;

pub(super) fn decode(
    bytes: &[u8],
    limits: &DecodeLimits,
    mut storage: Vec<u8>,
) -> Result<Frame, DecodeError> {
    let layout = Layout::read(bytes)?;
    let Layout { width, height } = layout;
    limits.check(FORMAT, width, height)?;
    if u64::from(width) * u64::from(height) > MAX_PIXELS_PER_BYTE * bytes.len() as u64 {
        return Err(DecodeError::Implausible { format: FORMAT, bytes: bytes.len(), width, height });
    }
    // Strict: the lenient mode fills what is missing with grey and reports success.
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(width as usize)
        .set_max_height(height as usize)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    storage.resize(3 * width as usize * height as usize, 0);
    decoder
        .decode_into(&mut storage)
        .map_err(|error| DecodeError::Malformed { format: FORMAT, reason: error.to_string() })?;
    super::frame(FORMAT, width, height, storage)
}

/// What the marker segments (T.81 annex B) say before any entropy-coded data is touched.
struct Layout {
    width: u32,
    height: u32,
}

impl Layout {
    /// Walks the segments to the first scan, and makes sure that the picture's end follows it.
    ///
    /// Entropy-coded data cannot contain the end marker, because its 0xff bytes are stuffed (T.81 B.1.1.5), so a
    /// picture without one after its first scan was cut off. (A thumbnail's end marker comes before the scan.)
    fn read(bytes: &[u8]) -> Result<Self, DecodeError> {
        let truncated = || DecodeError::Truncated { format: FORMAT, bytes: bytes.len() };
        let mut layout = None;
        let mut rest = bytes.get(2..).ok_or_else(truncated)?;
        loop {
            let (marker, after) = next_marker(rest).ok_or_else(truncated)?;
            if matches!(marker, 0x01 | 0xd0..=0xd7) {
                rest = after;
                continue;
            }
            let length = after.first_chunk().map(|&two| u16::from_be_bytes(two)).ok_or_else(truncated)?;
            let segment = after.get(2..usize::from(length).max(2)).ok_or_else(truncated)?;
            rest = &after[2 + segment.len()..];
            match marker {
                // SOF0–SOF15 without DHT, JPG and DAC, which share the range
                0xc0..=0xcf if !matches!(marker, 0xc4 | 0xc8 | 0xcc) => {
                    layout = Self::of_frame_header(segment)
                }
                0xda => break,
                0xd9 => return Err(truncated()),
                _ => {}
            }
        }
        if !rest.windows(2).rev().any(|pair| pair == [0xff, 0xd9]) {
            return Err(truncated());
        }
        layout.ok_or_else(|| DecodeError::Malformed {
            format: FORMAT,
            reason: "no frame header (SOF) before the first scan".to_owned(),
        })
    }

    /// Lines and samples per line of a frame header (T.81 B.2.2).
    fn of_frame_header(segment: &[u8]) -> Option<Self> {
        match *segment {
            [_precision, y1, y0, x1, x0, ..] => Some(Self {
                width: u16::from_be_bytes([x1, x0]).into(),
                height: u16::from_be_bytes([y1, y0]).into(),
            }),
            _ => None,
        }
    }
}

/// The next marker's code and what follows it; bytes that belong to no segment are skipped, as decoders do.
fn next_marker(mut rest: &[u8]) -> Option<(u8, &[u8])> {
    while let Some((&first, after)) = rest.split_first() {
        match (first, after.first()) {
            (0xff, Some(0x00 | 0xff)) | (0x00..=0xfe, _) => rest = after,
            (0xff, code) => return code.map(|&code| (code, &after[1..])),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::encode::{Quality, encode_jpeg};
    use jpeg_encoder::{ColorType, Encoder};

    fn limits() -> DecodeLimits {
        DecodeLimits::default()
    }

    fn textured(width: u16, height: u16) -> Frame {
        let rgb = (0..3 * u32::from(width) * u32::from(height))
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8 / 4 + 90)
            .collect();
        Frame::from_rgb(width.into(), height.into(), rgb).unwrap()
    }

    /// The bytes of `original` with another claimed size.
    fn claiming(original: &[u8], width: u16, height: u16) -> Vec<u8> {
        let mut bytes = original.to_vec();
        let sof = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
        bytes[sof + 5..sof + 7].copy_from_slice(&height.to_be_bytes());
        bytes[sof + 7..sof + 9].copy_from_slice(&width.to_be_bytes());
        bytes
    }

    #[test]
    fn a_picture_survives_the_round_trip() {
        let original = textured(133, 61);
        let decoded =
            super::super::decode(&encode_jpeg(&original, Quality::BEST).unwrap(), &limits()).unwrap();
        assert_eq!(decoded.size(), original.size());
        let worst = decoded.rgb().iter().zip(original.rgb()).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(worst <= 6, "off by {worst} levels");
    }

    #[test]
    fn grey_and_progressive_pictures_become_rgb() {
        let grey: Vec<u8> = (0..64 * 40).map(|i| (i % 64 * 3) as u8).collect();
        let mut bytes = Vec::new();
        Encoder::new(&mut bytes, 100).encode(&grey, 64, 40, ColorType::Luma).unwrap();
        let frame = super::super::decode(&bytes, &limits()).unwrap();
        let [r, g, b] = frame.pixel(30, 20);
        assert!(r == g && g == b && r.abs_diff(90) <= 2, "{r} {g} {b}");

        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 90);
        encoder.set_progressive(true);
        encoder.encode(textured(90, 70).rgb(), 90, 70, ColorType::Rgb).unwrap();
        assert_eq!(super::super::decode(&bytes, &limits()).unwrap().width(), 90);
    }

    #[test]
    fn a_picture_cut_anywhere_is_refused() {
        let whole = encode_jpeg(&textured(120, 90), Quality::default()).unwrap();
        for length in (3..whole.len() - 1).step_by(7) {
            let error = super::super::decode(&whole[..length], &limits()).unwrap_err();
            assert_eq!(error, DecodeError::Truncated { format: FORMAT, bytes: length });
        }
    }

    #[test]
    fn the_end_marker_of_a_thumbnail_does_not_count() {
        let whole = encode_jpeg(&textured(120, 90), Quality::default()).unwrap();
        let thumbnail =
            [&[0xff, 0xe1, 0x00, 0x06, 0xff, 0xd8, 0xff, 0xd9][..], &whole[2..whole.len() - 40]].concat();
        let cut = [&whole[..2], &thumbnail[..]].concat();
        assert!(matches!(super::super::decode(&cut, &limits()), Err(DecodeError::Truncated { .. })));
    }

    #[test]
    fn padding_behind_the_end_is_no_fault() {
        let mut bytes = encode_jpeg(&textured(40, 30), Quality::default()).unwrap();
        bytes.extend_from_slice(&[0; 100]);
        assert!(super::super::decode(&bytes, &limits()).is_ok());
    }

    #[test]
    fn a_header_that_claims_too_much_is_refused() {
        let small = encode_jpeg(&textured(40, 30), Quality::default()).unwrap();
        for (width, height) in [(13_000, 13_000), (50_000, 50_000), (8_193, 8), (8_000, 8_000)] {
            let error = super::super::decode(&claiming(&small, width, height), &limits()).unwrap_err();
            let too_large = DecodeError::TooLarge {
                format: FORMAT,
                width: width.into(),
                height: height.into(),
                limits: limits(),
            };
            assert_eq!(error, too_large);
        }
        let error = super::super::decode(&claiming(&small, 4_096, 4_096), &limits()).unwrap_err();
        assert!(matches!(error, DecodeError::Implausible { .. }), "{error}");
        let error = super::super::decode(&claiming(&small, 0, 30), &limits()).unwrap_err();
        assert_eq!(error, DecodeError::Empty { format: FORMAT, width: 0, height: 30 });
    }
}
