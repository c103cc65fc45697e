//! From a [`Frame`] to JPEG or PNG bytes.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use jpeg_encoder::{ChromaSubsamplingMethod, ColorType, Encoder};

use super::Frame;

/// JPEG quality, 1 (smallest) to 100 (best).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quality(u8);

impl Quality {
    /// The largest files and the smallest error.
    pub const BEST: Self = Self(100);

    /// The quality `value`.
    ///
    /// # Errors
    /// When `value` is not within 1 and 100.
    pub fn new(value: u8) -> Result<Self, QualityOutOfRange> {
        if (1..=100).contains(&value) { Ok(Self(value)) } else { Err(QualityOutOfRange { got: value }) }
    }

    /// The number, 1..=100.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl Default for Quality {
    /// 90: what cameras commonly send; chroma at full resolution.
    fn default() -> Self {
        Self(90)
    }
}

/// A JPEG quality that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("JPEG quality is {got}; it must be within 1 and 100")]
pub struct QualityOutOfRange {
    got: u8,
}

/// Why a frame could not be encoded.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// A JPEG's sides have 16 bits.
    #[error("a frame of {width}×{height} pixels does not fit into a JPEG, whose sides go up to 65535")]
    TooLargeForJpeg {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The JPEG encoder refused the frame.
    #[error("frame could not be encoded as JPEG")]
    Jpeg(#[from] jpeg_encoder::EncodingError),
    /// The PNG encoder refused the frame.
    #[error("frame could not be encoded as PNG")]
    Png(#[from] image::ImageError),
}

/// Encodes a baseline JPEG; below quality 90 chroma is halved in both directions.
///
/// # Errors
/// When the frame has no pixels or a side of more than 65,535.
pub fn encode_jpeg(frame: &Frame, quality: Quality) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (frame.width(), frame.height());
    let too_large = |_| EncodeError::TooLargeForJpeg { width, height };
    let (columns, rows) =
        (u16::try_from(width).map_err(too_large)?, u16::try_from(height).map_err(too_large)?);
    let mut bytes = Vec::with_capacity(frame.rgb().len() / 8);
    let mut encoder = Encoder::new(&mut bytes, quality.get());
    // By default halved chroma is that of every other pixel, half a pixel off in both directions.
    encoder.set_chroma_subsampling_method(ChromaSubsamplingMethod::Average);
    encoder.encode(frame.rgb(), columns, rows, ColorType::Rgb)?;
    Ok(bytes)
}

/// Encodes an 8-bit RGB PNG with fast compression.
///
/// # Errors
/// When the frame has no pixels.
pub fn encode_png(frame: &Frame) -> Result<Vec<u8>, EncodeError> {
    let mut bytes = Vec::with_capacity(frame.rgb().len() / 2);
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive).write_image(
        frame.rgb(),
        frame.width(),
        frame.height(),
        ExtendedColorType::Rgb8,
    )?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::decode::{DecodeLimits, decode};

    #[test]
    fn png_keeps_every_level() {
        let frame = Frame::from_rgb(31, 7, (0..31 * 7 * 3).map(|i| (i * 37 % 256) as u8).collect()).unwrap();
        assert_eq!(decode(&encode_png(&frame).unwrap(), &DecodeLimits::default()).unwrap(), frame);
    }

    #[test]
    fn quality_is_bounded_and_orders_the_size() {
        assert_eq!(Quality::new(0), Err(QualityOutOfRange { got: 0 }));
        assert_eq!(Quality::new(101), Err(QualityOutOfRange { got: 101 }));
        let frame =
            Frame::from_rgb(64, 64, (0..64 * 64 * 3).map(|i| (i * 31 % 201) as u8).collect()).unwrap();
        let size = |quality| encode_jpeg(&frame, Quality::new(quality).unwrap()).unwrap().len();
        assert!(size(10) < size(50) && size(50) < size(100));
    }

    #[test]
    fn halved_chroma_stays_in_its_place() {
        // Red and blue of one brightness: what tells them apart is chroma alone.
        let stripe = |x: usize| if (21..43).contains(&x) { [200, 40, 40] } else { [90, 60, 220] };
        let frame = Frame::from_rgb(64, 16, (0..16 * 64).flat_map(|at| stripe(at % 64)).collect()).unwrap();
        let bytes = encode_jpeg(&frame, Quality::new(80).unwrap()).unwrap();
        let seen = decode(&bytes, &DecodeLimits::default()).unwrap();
        let red = |x: u32| (f64::from(seen.pixel(x, 8)[0]) - 90.0) / 110.0;
        let weight: f64 = (0..64).map(red).sum();
        let centre = (0..64).map(|x| (f64::from(x) + 0.5) * red(x)).sum::<f64>() / weight;
        assert!((centre - 32.0).abs() < 0.15, "{centre}");
    }

    #[test]
    fn a_frame_that_no_jpeg_can_hold_is_refused() {
        let wide = Frame::from_rgb(65_536, 1, vec![0; 3 * 65_536]).unwrap();
        assert!(matches!(encode_jpeg(&wide, Quality::default()), Err(EncodeError::TooLargeForJpeg { .. })));
        assert!(encode_jpeg(&Frame::default(), Quality::default()).is_err());
        assert!(encode_png(&Frame::default()).is_err());
    }
}
