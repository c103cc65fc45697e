//! PNG (ISO/IEC 15948), every colour type and bit depth; alpha is ignored.

use std::io::{Cursor, ErrorKind};

use png::{ColorType, Decoder, DecodingError, Limits, Reader, Transformations};

use super::{DecodeError, DecodeLimits, Frame, PictureFormat};

const FORMAT: PictureFormat = PictureFormat::Png;

/// What the decoder may hold beside the picture: one inflate window, palettes and profiles.
const WORKING_BYTES: usize = 4 << 20;

pub(super) fn decode(
    bytes: &[u8],
    limits: &DecodeLimits,
    mut storage: Vec<u8>,
) -> Result<Frame, DecodeError> {
    let refused = |error| refusal(&error, bytes.len());
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: WORKING_BYTES });
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    decoder.set_ignore_text_chunk(true);
    let header = decoder.read_header_info().map_err(refused)?;
    let (width, height) = (header.width, header.height);
    limits.check(FORMAT, width, height)?;
    let mut reader = decoder.read_info().map_err(refused)?;
    read_rgb(&mut reader, width as usize, &mut storage).map_err(refused)?;
    super::frame(FORMAT, width, height, storage)
}

/// Row by row, so that no second picture is held while samples become RGB.
fn read_rgb(
    reader: &mut Reader<Cursor<&[u8]>>,
    width: usize,
    storage: &mut Vec<u8>,
) -> Result<(), DecodingError> {
    let (color, _eight_bits) = reader.output_color_type();
    if reader.info().interlaced {
        return read_interlaced(reader, storage);
    }
    storage.clear();
    while let Some(row) = reader.next_row()? {
        append_rgb(&row.data()[..width * color.samples()], color, storage);
    }
    Ok(())
}

/// Adam7 passes interleave rows, so the whole picture is decoded before it is converted.
fn read_interlaced(reader: &mut Reader<Cursor<&[u8]>>, storage: &mut Vec<u8>) -> Result<(), DecodingError> {
    let (color, _eight_bits) = reader.output_color_type();
    let mut samples = vec![0; reader.output_buffer_size().ok_or(DecodingError::LimitsExceeded)?];
    reader.next_frame(&mut samples)?;
    storage.clear();
    append_rgb(&samples, color, storage);
    Ok(())
}

fn append_rgb(samples: &[u8], color: ColorType, rgb: &mut Vec<u8>) {
    match color {
        ColorType::Rgb | ColorType::Indexed => rgb.extend_from_slice(samples),
        ColorType::Rgba => rgb.extend(samples.chunks_exact(4).flat_map(|px| [px[0], px[1], px[2]])),
        ColorType::Grayscale => rgb.extend(samples.iter().flat_map(|&level| [level; 3])),
        ColorType::GrayscaleAlpha => rgb.extend(samples.chunks_exact(2).flat_map(|px| [px[0]; 3])),
    }
}

fn refusal(error: &DecodingError, bytes: usize) -> DecodeError {
    match error {
        DecodingError::IoError(io) if io.kind() == ErrorKind::UnexpectedEof => {
            DecodeError::Truncated { format: FORMAT, bytes }
        }
        other => DecodeError::Malformed { format: FORMAT, reason: other.to_string() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use png::{BitDepth, Encoder};

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
            (ColorType::Grayscale, BitDepth::Sixteen, &[7, 200, 9, 1], [7, 7, 7, 9, 9, 9]),
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
            Encoder::new(&mut bytes, side, side).write_header().unwrap();
            let error = decoded(&bytes).unwrap_err();
            assert!(matches!(error, DecodeError::TooLarge { width, .. } if width == side), "{error}");
        }
    }
}
