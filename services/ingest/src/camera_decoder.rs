//! The pictures of one camera, whichever way they are compressed, each decoded in its turn.

use bytes::Bytes;
use video::{Decoded, StreamDecoder, VideoError};
use vision::Frame;
use vision::frame::decode::{DecodeError, DecodeLimits};

use crate::camera_thread::decode_into;
use crate::encoded::{EncodedFrame, Encoding};

/// Why a picture was not decoded.
#[derive(Debug, thiserror::Error)]
pub enum Undecoded {
    /// The picture itself.
    #[error(transparent)]
    Picture(#[from] DecodeError),
    /// The stream it belongs to.
    #[error(transparent)]
    Video(#[from] VideoError),
    /// A picture before it is missing.
    #[error("pictures that it needs are missing; the stream's next keyframe will be decoded again")]
    AwaitingKeyframe,
}

/// Decodes the pictures of one camera. Streams need every picture, in order, whether or not anybody looks at it.
#[derive(Debug)]
pub struct CameraDecoder {
    stream: StreamDecoder,
    /// Sequence number of the stream's last message.
    last: Option<u64>,
}

impl Default for CameraDecoder {
    fn default() -> Self {
        Self { stream: StreamDecoder::new(DecodeLimits::default()), last: None }
    }
}

impl CameraDecoder {
    /// Decodes the next picture into the storage of an earlier frame.
    ///
    /// # Errors
    /// When it is damaged, of an unknown format, larger than the limits, or needs pictures that are missing.
    pub fn decode_into(&mut self, picture: &EncodedFrame, pixels: Vec<u8>) -> Result<Frame, Undecoded> {
        if picture.encoding != Encoding::H264 {
            return Ok(decode_into(picture, pixels)?);
        }
        if self.last.replace(picture.sequence).is_some_and(|last| is_gap(last, picture.sequence)) {
            self.stream.interrupt();
        }
        match self.stream.decode(&picture.bytes, pixels)? {
            Decoded::Picture(frame) => Ok(frame),
            Decoded::AwaitingKeyframe => Err(Undecoded::AwaitingKeyframe),
        }
    }
}

/// Whether something lies between two messages. Recordings keep 32 bits of a sequence number, and foreign ones often
/// the same number for all.
fn is_gap(last: u64, next: u64) -> bool {
    let (last, next) = (last as u32, next as u32);
    next != last && next != last.wrapping_add(1)
}

/// A decoded picture in the place of its encoded form.
pub(crate) fn decoded_picture(encoded: &EncodedFrame, frame: Frame) -> EncodedFrame {
    let (width, height) = (frame.width(), frame.height());
    let encoding = Encoding::Raw { width, height, step: 3 * width, order: "rgb8".to_owned() };
    EncodedFrame { encoding, bytes: Bytes::from(frame.into_rgb()), ..*encoded }
}

#[cfg(test)]
mod tests {
    use super::*;
    use video::{EncoderOptions, Quantizer, StreamEncoder};
    use vision::Timestamp;

    fn messages(count: u64) -> Vec<EncodedFrame> {
        let options = EncoderOptions { quantizer: Quantizer::default(), keyframe_interval: 4 };
        let mut encoder = StreamEncoder::new(options).unwrap();
        let frame = Frame::from_rgb(64, 48, vec![90; 64 * 48 * 3]).unwrap();
        let message = |sequence| EncodedFrame {
            sequence,
            captured_at: Timestamp::from_nanos(sequence as i64),
            encoding: Encoding::H264,
            bytes: encoder.encode(&frame).unwrap().bytes.into(),
        };
        (0..count).map(message).collect()
    }

    fn shown(messages: &[EncodedFrame]) -> Vec<bool> {
        let mut decoder = CameraDecoder::default();
        messages.iter().map(|message| decoder.decode_into(message, Vec::new()).is_ok()).collect()
    }

    #[test]
    fn a_missing_message_is_noticed_by_its_number() {
        let mut sent = messages(10);
        sent.remove(2);
        assert_eq!(shown(&sent), [true, true, false, true, true, true, true, true, true]);
    }

    #[test]
    fn numbers_may_wrap_or_say_nothing() {
        let mut sent = messages(6);
        for (message, sequence) in sent.iter_mut().zip(u64::from(u32::MAX) - 2..) {
            message.sequence = u64::from(sequence as u32);
        }
        assert_eq!(shown(&sent), [true; 6]);
        sent.iter_mut().for_each(|message| message.sequence = 0);
        assert_eq!(shown(&sent), [true; 6]);
    }
}
