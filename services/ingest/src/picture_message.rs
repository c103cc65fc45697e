//! The pictures in messages, live and recorded: one reading, so that a replay sees what the camera's thread saw.

use waymark_proto::foxglove;
use waymark_proto::images::{self, UnusablePicture};
use waymark_proto::payload::{RefusedPayload, WireMessage};

use crate::encoded::{EncodedFrame, Encoding};

/// Why a message holds no usable picture.
#[derive(Debug, thiserror::Error)]
pub enum NoPicture {
    /// It cannot be decoded as a message.
    #[error(transparent)]
    Payload(#[from] RefusedPayload),
    /// Its description cannot be used.
    #[error(transparent)]
    Description(#[from] UnusablePicture),
    /// Video of another kind.
    #[error("video format is {0:?}; allowed: \"h264\"")]
    VideoFormat(String),
}

/// What kind of message a picture comes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKind {
    /// `foxglove.CompressedImage`.
    Compressed,
    /// `foxglove.CompressedVideo`.
    Video,
    /// `foxglove.RawImage`.
    Raw,
}

impl PictureKind {
    /// The kind with that schema, `None` where a schema holds no pictures.
    #[must_use]
    pub fn of_schema(schema: &str) -> Option<Self> {
        match schema {
            foxglove::CompressedImage::SCHEMA => Some(Self::Compressed),
            foxglove::CompressedVideo::SCHEMA => Some(Self::Video),
            foxglove::RawImage::SCHEMA => Some(Self::Raw),
            _ => None,
        }
    }

    /// The picture in a message of this kind.
    ///
    /// # Errors
    /// When the message cannot be decoded, or lacks what a picture needs.
    pub fn read(self, sequence: u64, message: &[u8]) -> Result<EncodedFrame, NoPicture> {
        match self {
            Self::Compressed => compressed(sequence, message),
            Self::Video => video(sequence, message),
            Self::Raw => raw(sequence, message),
        }
    }
}

fn compressed(sequence: u64, message: &[u8]) -> Result<EncodedFrame, NoPicture> {
    let image = foxglove::CompressedImage::from_payload(message)?;
    images::picture_format(&image)?;
    let captured_at = images::picture_captured_at(&image)?;
    Ok(EncodedFrame { sequence, captured_at, encoding: Encoding::File, bytes: image.data })
}

fn video(sequence: u64, message: &[u8]) -> Result<EncodedFrame, NoPicture> {
    let picture = foxglove::CompressedVideo::from_payload(message)?;
    if picture.format != "h264" {
        return Err(NoPicture::VideoFormat(picture.format.chars().take(32).collect()));
    }
    let timestamp = picture.timestamp.as_ref().ok_or(UnusablePicture::NoTimestamp)?;
    let captured_at = images::domain_time(timestamp);
    Ok(EncodedFrame { sequence, captured_at, encoding: Encoding::H264, bytes: picture.data })
}

fn raw(sequence: u64, message: &[u8]) -> Result<EncodedFrame, NoPicture> {
    let image = foxglove::RawImage::from_payload(message)?;
    let timestamp = image.timestamp.as_ref().ok_or(UnusablePicture::NoTimestamp)?;
    let captured_at = images::domain_time(timestamp);
    let encoding =
        Encoding::Raw { width: image.width, height: image.height, step: image.step, order: image.encoding };
    Ok(EncodedFrame { sequence, captured_at, encoding, bytes: image.data })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytes::Bytes;
    use prost::Message;
    use vision::Timestamp;
    use waymark_proto::images::{PictureFormat, picture_message};

    #[test]
    fn a_compressed_picture_keeps_its_stamps() {
        let at = Timestamp::from_nanos(1_700_000_000_123_456_789);
        let message = picture_message(PictureFormat::Jpeg, Bytes::from_static(b"jpeg"), at, "front");
        let frame = PictureKind::Compressed.read(7, &message.encode_to_vec()).unwrap();
        assert_eq!((frame.sequence, frame.captured_at, &frame.bytes[..]), (7, at, &b"jpeg"[..]));
    }

    #[test]
    fn video_is_a_picture_of_a_stream_if_it_is_h264() {
        let at = Timestamp::from_nanos(1_700_000_000_123_456_789);
        let message = |format: &str| foxglove::CompressedVideo {
            timestamp: images::foxglove_time(at),
            frame_id: "front".to_owned(),
            data: Bytes::from_static(b"stream"),
            format: format.to_owned(),
        };
        let read = |format| PictureKind::Video.read(7, &message(format).encode_to_vec());
        let frame = read("h264").unwrap();
        assert_eq!((frame.sequence, frame.captured_at, frame.encoding), (7, at, Encoding::H264));
        assert!(matches!(read("av1"), Err(NoPicture::VideoFormat(format)) if format == "av1"));
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        assert_eq!(PictureKind::of_schema("foxglove.Log"), None);
        assert!(PictureKind::Compressed.read(1, &[0xff; 8]).is_err());
    }
}
