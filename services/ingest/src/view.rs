//! Frames as they are shown: scaled and encoded as a viewer asked for them.

use fast_image_resize::images::{Image, ImageRef};
use fast_image_resize::{FilterType, PixelType, ResizeAlg, ResizeOptions, Resizer};
use http_face::{Format, PictureRequest};
use vision::Frame;
use vision::frame::encode::{self, Quality};

/// JPEG quality where none is asked for.
const DEFAULT_QUALITY: u8 = 80;

/// The frame at the width, in the format and with the quality asked for; layers are for its owner to have drawn.
///
/// # Errors
/// In words for the viewer, when it cannot be encoded.
pub fn encoded(frame: Frame, request: &PictureRequest) -> Result<Vec<u8>, String> {
    let frame = match request.width_px {
        Some(width_px) if width_px < frame.width() => scaled_to_width(&frame, width_px)?,
        _ => frame,
    };
    let quality =
        Quality::new(request.quality.unwrap_or(DEFAULT_QUALITY)).map_err(|error| error.to_string())?;
    match request.format {
        Format::Jpeg => encode::encode_jpeg(&frame, quality),
        Format::Png => encode::encode_png(&frame),
    }
    .map_err(|error| error.to_string())
}

/// The same picture, smaller.
fn scaled_to_width(frame: &Frame, width_px: u32) -> Result<Frame, String> {
    let height_px =
        (u64::from(frame.height()) * u64::from(width_px) / u64::from(frame.width().max(1))).max(1) as u32;
    let source = ImageRef::new(frame.width(), frame.height(), frame.rgb(), PixelType::U8x3);
    let mut smaller = Image::new(width_px, height_px, PixelType::U8x3);
    let options = ResizeOptions::new().resize_alg(ResizeAlg::Convolution(FilterType::Box));
    source.map_err(|error| error.to_string()).and_then(|source| {
        Resizer::new().resize(&source, &mut smaller, &options).map_err(|error| error.to_string())
    })?;
    Frame::from_rgb(width_px, height_px, smaller.into_vec()).map_err(|error| error.to_string())
}
