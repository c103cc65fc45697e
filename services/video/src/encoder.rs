//! Frames to a live H.264 stream: Annex B, parameter sets before every IDR picture, no bidirectional pictures.

use openh264::OpenH264API;
use openh264::encoder::{
    Encoder, EncoderConfig, FrameType, IntraFramePeriod, QpRange, RateControlMode, VuiConfig,
};
use openh264::formats::YUVSlices;
use vision::{Frame, SizePx};

use crate::colour::planes_from_rgb;
use crate::error::VideoError;

/// How a stream is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderOptions {
    /// Step of quantisation, the same for every picture so that none is blurred to save bits.
    pub quantizer: Quantizer,
    /// An IDR picture comes after that many pictures.
    pub keyframe_interval: u32,
}

/// `QP` of ITU-T H.264: 1 keeps nearly everything, six more double the step, 51 is the coarsest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantizer(u8);

impl Quantizer {
    /// The quantizer `value`; `None` when it is not within 1 and 51.
    #[must_use]
    pub const fn new(value: u8) -> Option<Self> {
        if value >= 1 && value <= 51 { Some(Self(value)) } else { None }
    }
}

impl Default for Quantizer {
    /// 24: no difference that an eye would see, a quarter of the bytes of a JPEG.
    fn default() -> Self {
        Self(24)
    }
}

/// An encoded picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedPicture {
    /// Annex B.
    pub bytes: Vec<u8>,
    /// Whether it is an IDR picture.
    pub keyframe: bool,
}

/// Encodes one stream.
pub struct StreamEncoder {
    encoder: Encoder,
    size: Option<SizePx>,
}

impl StreamEncoder {
    /// An encoder whose first picture is an IDR picture.
    ///
    /// # Errors
    /// When the codec does not start.
    pub fn new(options: EncoderOptions) -> Result<Self, VideoError> {
        let config = EncoderConfig::new()
            .qp(QpRange::new(options.quantizer.0, options.quantizer.0))
            .intra_frame_period(IntraFramePeriod::from_num_frames(options.keyframe_interval))
            .rate_control_mode(RateControlMode::Bufferbased)
            .vui(VuiConfig::bt709())
            // Every frame that goes in comes out, and nothing is smoothed that somebody wants to measure.
            .skip_frames(false)
            .adaptive_quantization(false)
            .background_detection(false)
            .scene_change_detect(false)
            .num_threads(1);
        let encoder = Encoder::with_api_config(OpenH264API::from_source(), config)
            .map_err(|error| VideoError::Codec(error.to_string()))?;
        Ok(Self { encoder, size: None })
    }

    /// Encodes a frame; an odd last column or row is left out, since chroma has half the resolution.
    ///
    /// # Errors
    /// When its size cannot be encoded, or the codec fails.
    pub fn encode(&mut self, frame: &Frame) -> Result<EncodedPicture, VideoError> {
        let (width, height) = (frame.width(), frame.height());
        let fits = width.min(height) >= 16 && width.max(height) <= 3840 && width.min(height) <= 2160;
        if !fits {
            return Err(VideoError::NotEncodable { width, height });
        }
        let even = ((width & !1) as usize, (height & !1) as usize);
        let planes = planes_from_rgb(frame.rgb(), width as usize, even);
        let (luma, chroma) = planes.split_at(even.0 * even.1);
        let (blue, red) = chroma.split_at(chroma.len() / 2);
        let source = YUVSlices::new((luma, blue, red), even, (even.0, even.0 / 2, even.0 / 2));
        if self.size.replace(frame.size()).is_some_and(|size| size != frame.size()) {
            self.encoder.force_intra_frame();
        }
        let stream = self.encoder.encode(&source).map_err(|error| VideoError::Encode(error.to_string()))?;
        let bytes = stream.to_vec();
        if bytes.is_empty() {
            return Err(VideoError::Encode("the codec left the picture out".to_owned()));
        }
        Ok(EncodedPicture { bytes, keyframe: stream.frame_type() == FrameType::IDR })
    }
}

impl std::fmt::Debug for StreamEncoder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StreamEncoder").field("size", &self.size).finish_non_exhaustive()
    }
}
