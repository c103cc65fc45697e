//! Brings a source's pictures into the form in which they are sent.

use std::time::Duration;

use bytes::Bytes;
use ingest::camera_decoder::CameraDecoder;
use ingest::encoded::{EncodedFrame, Encoding};
use simulator::TrueObject;
use video::{EncoderOptions, Quantizer, StreamEncoder};
use vision::Frame;
use vision::frame::encode::{Quality, encode_jpeg};

use crate::config::{CameraConfig, SentEncoding};
use crate::error::CameraError;
use crate::shots::{Shot, Shots};

/// A picture in the form in which it is sent.
pub(crate) struct Sendable {
    /// How the bytes are to be read.
    pub(crate) encoding: Encoding,
    /// The picture.
    pub(crate) bytes: Bytes,
    /// Time since the previous picture, where the source has times of its own.
    pub(crate) since_previous: Option<Duration>,
    /// What is really there, where somebody knows.
    pub(crate) truth: Option<Vec<TrueObject>>,
}

/// A source and what makes its pictures sendable.
pub(crate) struct Sendables {
    pub(crate) shots: Shots,
    coder: Coder,
}

impl Sendables {
    pub(crate) fn open(config: &CameraConfig) -> Result<Self, CameraError> {
        Ok(Self { coder: Coder::new(config)?, shots: Shots::open(config)? })
    }

    /// The next picture, `None` at the end. One that cannot be decoded is left out.
    pub(crate) fn next(&mut self) -> Result<Option<Sendable>, CameraError> {
        while let Some(Shot { content, since_previous, truth }) = self.shots.next()? {
            match self.coder.encode(content) {
                Ok((encoding, bytes)) => {
                    return Ok(Some(Sendable { encoding, bytes, since_previous, truth }));
                }
                Err(CameraError::Decode(error)) => tracing::warn!(%error, "a picture is left out"),
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }
}

/// A picture as its source has it.
pub(crate) enum Content {
    /// Encoded already.
    Encoded(EncodedFrame),
    /// Bare pixels.
    Frame(Frame),
}

/// Brings pictures into one form, one after the other.
pub(crate) enum Coder {
    /// Pictures by themselves; what is encoded stays as it is.
    Jpeg(Quality),
    /// Video; what is video already stays as it is.
    H264(Box<VideoCoder>),
}

/// Video, from pictures of any kind.
pub(crate) struct VideoCoder {
    decoder: CameraDecoder,
    encoder: StreamEncoder,
    pixels: Vec<u8>,
}

impl Coder {
    pub(crate) fn new(config: &CameraConfig) -> Result<Self, CameraError> {
        match config.encoding {
            SentEncoding::Jpeg => {
                let quality = Quality::new(config.jpeg_quality);
                Ok(Self::Jpeg(
                    quality
                        .map_err(|_| out_of_range("jpeg_quality", config.jpeg_quality.into(), "1 to 100"))?,
                ))
            }
            SentEncoding::H264 => {
                let h264 = config.h264;
                let quantizer = Quantizer::new(h264.quantizer)
                    .ok_or_else(|| out_of_range("h264.quantizer", h264.quantizer.into(), "1 to 51"))?;
                let keyframe_interval = h264.keyframe_interval;
                if !(1..=600).contains(&keyframe_interval) {
                    return Err(out_of_range(
                        "h264.keyframe_interval",
                        keyframe_interval,
                        "1 to 600 pictures",
                    ));
                }
                let encoder = StreamEncoder::new(EncoderOptions { quantizer, keyframe_interval })?;
                let decoder = CameraDecoder::default();
                Ok(Self::H264(Box::new(VideoCoder { decoder, encoder, pixels: Vec::new() })))
            }
        }
    }

    /// The picture in the form in which it is sent.
    pub(crate) fn encode(&mut self, content: Content) -> Result<(Encoding, Bytes), CameraError> {
        match (self, content) {
            (Self::Jpeg(_), Content::Encoded(picture)) => Ok((picture.encoding, picture.bytes)),
            (Self::Jpeg(quality), Content::Frame(frame)) => {
                Ok((Encoding::File, encode_jpeg(&frame, *quality)?.into()))
            }
            (Self::H264(coder), content) => coder.encode(content),
        }
    }
}

impl VideoCoder {
    fn encode(&mut self, content: Content) -> Result<(Encoding, Bytes), CameraError> {
        let frame = match content {
            Content::Encoded(picture) if picture.encoding == Encoding::H264 => {
                return Ok((picture.encoding, picture.bytes));
            }
            Content::Encoded(picture) => {
                self.decoder.decode_into(&picture, std::mem::take(&mut self.pixels))?
            }
            Content::Frame(frame) => frame,
        };
        let bytes = self.encoder.encode(&frame)?.bytes.into();
        self.pixels = frame.into_rgb();
        Ok((Encoding::H264, bytes))
    }
}

fn out_of_range(name: &'static str, value: u32, allowed: &'static str) -> CameraError {
    CameraError::OutOfRange { name, value: value.to_string(), allowed }
}
