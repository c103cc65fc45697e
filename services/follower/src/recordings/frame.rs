//! One recorded picture with what was seen in it.

use bytes::Bytes;
use ingest::camera_decoder::{CameraDecoder, Undecoded};
use ingest::encoded::{EncodedFrame, Encoding};
use ingest::picture_message::{NoPicture, PictureKind};
use recording::RecordingError;
use recording::excerpt::{Excerpt, Selection};
use recording::timeline::Timeline;
use recording::walk::RecordedMessage;
use vision::{Frame, Timestamp};

use super::Found;
use super::registrations::{Recorded, recorded_in};
use super::topics::CameraTopics;

/// A registration is recorded after its picture, and not much later.
const REGISTERED_WITHIN_NS: u64 = 2_000_000_000;

/// How many pictures of a film are decoded before the one that is wanted, until one of them is a keyframe.
const LOOK_BACK: [usize; 4] = [0, 31, 127, 511];

/// A recorded picture.
pub(super) struct RecordedFrame {
    pub(super) sequence: u64,
    pub(super) captured_at: Timestamp,
    /// What was seen in it live; absent where it was not registered.
    pub(super) recorded: Option<Recorded>,
    picture: EncodedFrame,
    place: usize,
}

/// Why a recorded picture cannot be shown.
#[derive(Debug, thiserror::Error)]
pub(super) enum NotShown {
    /// There are not so many.
    #[error("the recording has {frames} pictures of this camera; allowed: 0 to {}", frames.saturating_sub(1))]
    Beyond { frames: usize },
    /// The file.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The message.
    #[error(transparent)]
    Message(#[from] NoPicture),
    /// The picture.
    #[error(transparent)]
    Picture(#[from] Undecoded),
    /// The message's kind.
    #[error("messages of schema {0:?} hold no pictures")]
    Schema(String),
}

impl RecordedFrame {
    /// Picture `n` of a camera, counted from 0 in the order of the recording.
    pub(super) fn read(
        found: &Found,
        timeline: &Timeline,
        topics: &CameraTopics,
        n: usize,
    ) -> Result<Self, NotShown> {
        let mut messages = timeline.messages(&found.path, &topics.image, n..n.saturating_add(1))?;
        let message =
            messages.next().ok_or(NotShown::Beyond { frames: timeline.of(&topics.image).len() })??;
        let picture = picture_of(&message)?;
        let captured_at = picture.captured_at;
        let recorded = recorded_of(found, topics, &message, captured_at)?;
        let sequence = recorded.as_ref().map_or(picture.sequence, |recorded| recorded.outcome.sequence);
        Ok(Self { sequence, captured_at, recorded, picture, place: n })
    }

    /// The picture as it was recorded, where it is a JPEG.
    pub(super) fn own_jpeg(&self) -> Option<Bytes> {
        self.picture.own_jpeg()
    }

    /// Its pixels; of a film the pictures before it are decoded too.
    pub(super) fn decode(
        &self,
        found: &Found,
        timeline: &Timeline,
        topics: &CameraTopics,
    ) -> Result<Frame, NotShown> {
        if self.picture.encoding != Encoding::H264 {
            return Ok(CameraDecoder::default().decode_into(&self.picture, Vec::new())?);
        }
        let mut failed = Undecoded::AwaitingKeyframe;
        for back in LOOK_BACK {
            let first = self.place.saturating_sub(back);
            let mut decoder = CameraDecoder::default();
            for message in timeline.messages(&found.path, &topics.image, first..self.place)? {
                // Pictures before a keyframe cannot be decoded; whether it is enough shows at the one that is wanted.
                let _not_wanted = decoder.decode_into(&picture_of(&message?)?, Vec::new());
            }
            match decoder.decode_into(&self.picture, Vec::new()) {
                Ok(frame) => return Ok(frame),
                Err(error) if first == 0 => return Err(error.into()),
                Err(error) => failed = error,
            }
        }
        Err(failed.into())
    }
}

fn picture_of(message: &RecordedMessage) -> Result<EncodedFrame, NotShown> {
    let schema = message.channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
    let kind = PictureKind::of_schema(schema).ok_or_else(|| NotShown::Schema(schema.to_owned()))?;
    Ok(kind.read(message.sequence.into(), &message.data)?)
}

/// What was said live of the picture in `message`.
fn recorded_of(
    found: &Found,
    topics: &CameraTopics,
    message: &RecordedMessage,
    captured_at: Timestamp,
) -> Result<Option<Recorded>, RecordingError> {
    let from_ns = message.log_time_ns;
    let log_time_ns = from_ns..from_ns.saturating_add(REGISTERED_WITHIN_NS);
    let selection = Selection { topics: Some([topics.registration.clone()].into()), log_time_ns };
    for registration in Excerpt::open(&found.path, selection)? {
        let recorded = recorded_in(&registration?);
        let is_of_it = |Recorded { outcome, .. }: &Recorded| {
            outcome.captured_at == captured_at && outcome.sequence as u32 == message.sequence
        };
        if let Some(recorded) = recorded.filter(is_of_it) {
            return Ok(Some(recorded));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::recordings::Shelf;
    use crate::recordings::registrations::page;

    /// A reference drive under a name that the recorder would give it.
    fn shelf(place: &Path, drive: &str) -> (Shelf, Found) {
        let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../recordings/reference").join(drive);
        let name = "car-20240301T000000Z-0001.mcap";
        std::fs::copy(recorded, place.join(name)).unwrap();
        let shelf = Shelf::new(place);
        let found = shelf.find(name).unwrap().unwrap();
        (shelf, found)
    }

    #[test]
    fn every_picture_comes_with_what_was_seen_in_it_and_pages_join_up() {
        let place = tempfile::tempdir().unwrap();
        let (shelf, found) = shelf(place.path(), "rink.mcap");
        let (timeline, topics) = shelf.camera(&found, None).unwrap();
        let frames = timeline.of(&topics.image).len();
        let (mut paged, mut from) = (Vec::new(), Some(0));
        while let Some(place) = from {
            let camera = topics.camera.clone();
            let page = page(&found, &timeline, camera, &topics.registration, place, 7).unwrap();
            paged.extend(page.registrations);
            from = page.next.map(|next| next.parse().unwrap());
        }
        assert_eq!(paged.len(), timeline.of(&topics.registration).len());
        let landmarks = shelf.landmarks(&found).unwrap();
        let mut registered = 0;
        for n in (0..frames).step_by(5) {
            let frame = RecordedFrame::read(&found, &timeline, &topics, n).unwrap();
            if let Some(Recorded { outcome, places }) = &frame.recorded {
                registered += 1;
                let is_known = |digest| landmarks.iter().any(|landmark| landmark.digest == digest);
                assert!(outcome.landmarks.iter().all(|one| is_known(one.digest)));
                assert_eq!(places.len(), outcome.landmarks.len());
                assert_eq!(outcome.captured_at, frame.captured_at);
                assert!(paged.iter().any(|one| one.captured_at_ns == frame.captured_at.nanos));
            }
        }
        assert!(registered * 5 >= frames / 2, "{registered} of every fifth of {frames}");
        let first = RecordedFrame::read(&found, &timeline, &topics, 0).unwrap();
        assert_eq!(first.own_jpeg().as_deref(), Some(&first.picture.bytes[..]));
        assert!(first.decode(&found, &timeline, &topics).unwrap().width() > 0);
        let beyond = RecordedFrame::read(&found, &timeline, &topics, frames);
        assert!(matches!(beyond, Err(NotShown::Beyond { .. })));
        assert!(shelf.camera(&found, Some("rear")).is_err());
    }
}
