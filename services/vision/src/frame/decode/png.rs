//! PNG (ISO/IEC 15948), every colour type and bit depth; alpha is ignored.

use std::io::{Cursor, ErrorKind};

use image::codecs::png::PngDecoder;
use image::error::ImageError;
use image::{DynamicImage, ImageDecoder, Limits};

use super::{DecodeError, DecodeLimits, Frame, PictureFormat};

const FORMAT: PictureFormat = PictureFormat::Png;

/// What the decoder may hold beside the picture: one inflate window, palettes and profiles.
const WORKING_BYTES: u64 = 4 << 20;

/// Decodes a PNG. The pixels get storage of their own: the decoder hands them out as a whole.
pub(super) fn decode(bytes: &[u8], limits: &DecodeLimits) -> Result<Frame, DecodeError> {
    let refused = |error| refusal(&error, bytes.len());
    let mut header = Limits::no_limits();
    header.max_alloc = Some(WORKING_BYTES);
    let mut decoder = PngDecoder::with_limits(Cursor::new(bytes), header).map_err(refused)?;
    let (width, height) = decoder.dimensions();
    limits.check(FORMAT, width, height)?;
    let mut whole = Limits::no_limits();
    whole.max_alloc = Some(decoder.total_bytes().saturating_add(WORKING_BYTES));
    decoder.set_limits(whole).map_err(refused)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(refused)?;
    super::frame(FORMAT, width, height, picture.into_rgb8().into_raw())
}

fn refusal(error: &ImageError, bytes: usize) -> DecodeError {
    match error {
        ImageError::IoError(io) if io.kind() == ErrorKind::UnexpectedEof => {
            DecodeError::Truncated { format: FORMAT, bytes }
        }
        other => DecodeError::Malformed { format: FORMAT, reason: other.to_string() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use png::{BitDepth, ColorType, Encoder};

    fn encoded(width: u32, height: u32, color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![10, 20, 30, 40, 50, 60]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    fn decoded(bytes: &[u8]) -> Result<Frame, DecodeError> {
        super::super::decode(bytes, &DecodeLimits::default())
    }

    #[test]
    fn every_colour_type_becomes_rgb() {
        let cases: [(ColorType, BitDepth, &[u8], [u8; 6]); 7] = [
            (ColorType::Rgb, BitDepth::Eight, &[1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5, 6]),
            (ColorType::Rgba, BitDepth::Eight, &[1, 2, 3, 0, 4, 5, 6, 255], [1, 2, 3, 4, 5, 6]),
            (ColorType::Grayscale, BitDepth::Eight, &[7, 9], [7, 7, 7, 9, 9, 9]),
            (ColorType::GrayscaleAlpha, BitDepth::Eight, &[7, 0, 9, 0], [7, 7, 7, 9, 9, 9]),
            (ColorType::Grayscale, BitDepth::One, &[0b0100_0000], [0, 0, 0, 255, 255, 255]),
            (ColorType::Indexed, BitDepth::One, &[0b1000_0000], [40, 50, 60, 10, 20, 30]),
            (ColorType::Grayscale, BitDepth::Sixteen, &[7, 7, 9, 1], [7, 7, 7, 9, 9, 9]),
        ];
        for (color, depth, data, rgb) in cases {
            let frame = decoded(&encoded(2, 1, color, depth, data)).unwrap();
            assert_eq!(frame.rgb(), rgb, "{color:?} {depth:?}");
        }
    }

    #[test]
    fn a_picture_cut_anywhere_is_refused() {
        let data: Vec<u8> = (0..60 * 40 * 3).map(|i| (i * 31 % 251) as u8).collect();
        let whole = encoded(60, 40, ColorType::Rgb, BitDepth::Eight, &data);
        for length in (8..whole.len() - 16).step_by(11) {
            let error = decoded(&whole[..length]).unwrap_err();
            assert!(
                matches!(error, DecodeError::Truncated { .. } | DecodeError::Malformed { .. }),
                "{error}"
            );
        }
    }

    #[test]
    fn a_header_that_claims_too_much_is_refused() {
        for side in [13_000, 50_000] {
            let mut bytes = Vec::new();
            let mut header = Encoder::new(&mut bytes, side, side).write_header().unwrap();
            header.write_chunk(png::chunk::IDAT, &[]).unwrap();
            drop(header);
            let error = decoded(&bytes).unwrap_err();
            assert!(matches!(error, DecodeError::TooLarge { width, .. } if width == side), "{error}");
        }
    }
}
