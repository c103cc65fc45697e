//! A live stream, as `foxglove.CompressedVideo` carries it: Annex B, one picture a message, parameter sets before every
//! IDR, no bidirectional pictures. What goes in comes out at once.

use vision::Frame;
use vision::frame::decode::DecodeLimits;

use crate::access_unit::{NalKind, is_bidirectional, nal_units};
use crate::error::VideoError;
use crate::picture::{Order, PictureDecoder};

/// What became of a message of a stream.
#[derive(Debug, PartialEq, Eq)]
pub enum Decoded {
    /// Its picture.
    Picture(Frame),
    /// Nothing: pictures that it needs are missing, so it waits for one that needs none.
    AwaitingKeyframe,
}

/// Whether a message's picture needs no other: a stream can be taken up with it.
#[must_use]
pub fn is_keyframe(message: &[u8]) -> bool {
    let slices =
        nal_units(message).map(NalKind::of).filter(|kind| matches!(kind, NalKind::Slice | NalKind::IdrSlice));
    slices.take(1).any(|kind| kind == NalKind::IdrSlice)
}

/// Decodes one camera's stream; it must see every message, whether or not anybody looks at the picture.
pub struct StreamDecoder {
    limits: DecodeLimits,
    /// `None` until an IDR picture comes.
    decoder: Option<PictureDecoder>,
}

impl StreamDecoder {
    /// A decoder at the beginning of a stream or somewhere within it.
    #[must_use]
    pub fn new(limits: DecodeLimits) -> Self {
        Self { limits, decoder: None }
    }

    /// A message is missing: until the next IDR picture nothing can be trusted.
    pub fn interrupt(&mut self) {
        self.decoder = None;
    }

    /// Decodes the message that follows, into the storage of an earlier frame.
    ///
    /// # Errors
    /// When it is damaged, too large, or of a kind that is not decoded; the stream then waits for its next IDR picture.
    pub fn decode(&mut self, message: &[u8], storage: Vec<u8>) -> Result<Decoded, VideoError> {
        let units: Vec<&[u8]> = nal_units(message).collect();
        let of_kind = |kind| units.iter().any(|unit| NalKind::of(unit) == kind);
        let decoder = match self.decoder.take() {
            Some(decoder) => decoder,
            // A stream that is taken up again gets a new decoder: whatever the old one kept is from before the gap.
            None if of_kind(NalKind::IdrSlice) => PictureDecoder::new(self.limits, Order::Decoding)?,
            None if of_kind(NalKind::Slice) => return Ok(Decoded::AwaitingKeyframe),
            None => return Err(VideoError::damaged("a message holds no picture")),
        };
        let mut slices = units.iter().filter(|unit| NalKind::of(unit) == NalKind::Slice);
        if slices.any(|slice| is_bidirectional(slice)) {
            return Err(VideoError::Unsupported {
                what: "bidirectional pictures (B-frames), which come late".to_owned(),
                allowed: "configure the camera to send none",
            });
        }
        let decoder = self.decoder.insert(decoder);
        match decoder.feed(units.iter().copied(), storage) {
            Ok(Some(frame)) => Ok(Decoded::Picture(frame)),
            Ok(None) => {
                self.decoder = None;
                Err(VideoError::damaged("a message holds no whole picture"))
            }
            Err(error) => {
                self.decoder = None;
                Err(error)
            }
        }
    }
}

impl std::fmt::Debug for StreamDecoder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StreamDecoder")
            .field("awaits_keyframe", &self.decoder.is_none())
            .finish_non_exhaustive()
    }
}
