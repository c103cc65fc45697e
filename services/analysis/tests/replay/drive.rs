//! A drive recorded as a follower records it, pictures and results and all state, without a follower.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use ingest::recorded::{LANDMARKS_ATTACHMENT, SUPERSEDED_ATTACHMENT};
use recording::{
    Attachment, ChannelSpec, Command, Journal, JournalOptions, Latch, LatchKey, Message, Offered, Schema,
};
use video::{Decoded, EncoderOptions, Quantizer, StreamDecoder, StreamEncoder};
use vision::follow::{Follow, FollowOptions, FollowState, FrameStamp};
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::{
    ColorStats, Digest, Frame, Landmark, LandmarkSet, NoProbe, Outcome, SetVersion, ShapeClass, Timestamp,
    WindowPx,
};
use waymark_proto::convert::{follow_state_to_wire, landmark_to_wire, manifest_of, registration_to_wire};
use waymark_proto::digest::landmark_digest;
use waymark_proto::foxglove;
use waymark_proto::images::{PictureFormat, foxglove_time, picture_message};
use waymark_proto::json::{landmarks_to_json, set_to_json};
use waymark_proto::payload::WireMessage;

pub(crate) const CAMERA: &str = "front";
const IMAGE_TOPIC: &str = "/v2/camera/front/image";
const FRAMES: u64 = 24;
/// Begins beyond 32 bits: MCAP keeps only the low half of a sequence number.
pub(crate) const FIRST_SEQUENCE: u64 = (1 << 32) + 5;

/// A red square on grey that moves to the right.
fn picture(number: u64) -> Frame {
    let (left, top) = (20 + 2 * number as u32, 30);
    let square = |x: u32, y: u32| (left..left + 18).contains(&x) && (top..top + 18).contains(&y);
    let colour =
        |x: u32, y: u32| if square(x, y) { [200, 40, 30] } else { [(90 + (x * 7 + y * 13) % 23) as u8; 3] };
    let rgb = (0..96).flat_map(|y| (0..128).flat_map(move |x| colour(x, y))).collect();
    Frame::from_rgb(128, 96, rgb).unwrap()
}

pub(crate) fn landmark(id: &str, red: f32) -> Arc<Landmark> {
    let mut landmark = Landmark {
        id: id.to_owned(),
        revision: 1,
        window_px: WindowPx::square(8),
        shades: vec![ColorStats { mean: [red, 40.0, 30.0], variance: [0.0; 3] }],
        tolerance: ColorStats::uniform(20.0, 60.0),
        shape: ShapeClass::Block,
        size_m: None,
        digest: Digest::default(),
    };
    landmark.digest = landmark_digest(&landmark);
    Arc::new(landmark)
}

pub(crate) fn set(version: u64, landmarks: Vec<Arc<Landmark>>) -> LandmarkSet {
    LandmarkSet { version: SetVersion { epoch: 3, version }, landmarks }
}

struct Drive {
    journal: Journal,
    now_ns: u64,
    in_force: Vec<Arc<Landmark>>,
}

impl Drive {
    fn record<M: WireMessage>(&mut self, topic: &str, sequence: u64, message: &M) {
        let now = Timestamp::from_nanos(self.now_ns as i64);
        self.record_as(topic, sequence, now, message, Latch::None);
    }

    fn record_as<M: WireMessage>(
        &mut self,
        topic: &str,
        sequence: u64,
        captured_at: Timestamp,
        message: &M,
        latch: Latch,
    ) {
        self.now_ns += 1_000_000;
        let schema =
            Schema { name: M::SCHEMA.to_owned(), file_descriptor_set: M::descriptors().into_owned().into() };
        let channel =
            Arc::new(ChannelSpec { topic: topic.to_owned(), key_expression: String::new(), schema });
        let _counted = self.journal.offer(Message {
            channel,
            log_time_ns: self.now_ns,
            publish_time_ns: captured_at.nanos as u64,
            sequence: sequence as u32,
            data: message.encode_to_vec().into(),
            latch,
        });
    }

    /// Records a set as a follower does.
    fn landmarks(&mut self, set: &LandmarkSet) {
        let SetVersion { epoch, version } = set.version;
        let now = Timestamp::from_nanos(self.now_ns as i64);
        for old in &self.in_force {
            if set.landmarks.iter().all(|landmark| landmark.id != old.id) {
                assert_eq!(self.journal.forget(LatchKey(old.id.clone())), Offered::Accepted);
            }
        }
        let superseded = std::mem::replace(&mut self.in_force, set.landmarks.clone());
        self.attach(SUPERSEDED_ATTACHMENT, landmarks_to_json(superseded.iter().map(Arc::as_ref)).unwrap());
        for landmark in &set.landmarks {
            let latch = Latch::Repeat(LatchKey(landmark.id.clone()));
            self.record_as("/lead/landmark", version, now, &landmark_to_wire(landmark, epoch), latch);
        }
        // The last of a head, as its key sorts behind every landmark's.
        let latch = Latch::Repeat(LatchKey("~manifest".to_owned()));
        self.record_as("/lead/manifest", version, now, &manifest_of(set), latch);
        self.attach(LANDMARKS_ATTACHMENT, set_to_json(set).unwrap());
    }

    /// Records a picture as if something were drawn into it: no picture of a camera.
    fn burned_in(&mut self, frame: &Frame, stamp: FrameStamp) {
        let FrameStamp { sequence, captured_at } = stamp;
        let bytes = Bytes::from(encode_jpeg(frame, Quality::default()).unwrap());
        let message = picture_message(PictureFormat::Jpeg, bytes, captured_at, CAMERA);
        self.record_as("/v2/camera/front/burned_in", sequence, captured_at, &message, Latch::None);
    }

    fn attach(&self, name: &str, text: String) {
        let attached = self.journal.attach(Attachment {
            name: name.to_owned(),
            media_type: "application/json".to_owned(),
            log_time_ns: self.now_ns,
            data: text.into(),
        });
        assert_eq!(attached, Offered::Accepted);
    }
}

/// What a picture is sent as, and what the other side makes of it.
pub(crate) enum Coding {
    Jpeg,
    Video(Box<(StreamEncoder, StreamDecoder)>),
}

impl Coding {
    /// Video with a keyframe every sixth picture.
    pub(crate) fn video() -> Self {
        let options = EncoderOptions { quantizer: Quantizer::default(), keyframe_interval: 6 };
        Self::Video(Box::new((
            StreamEncoder::new(options).unwrap(),
            StreamDecoder::new(DecodeLimits::default()),
        )))
    }

    /// Records `frame` unless that is `lost`, and returns what arrives of it.
    fn send(&mut self, frame: &Frame, drive: &mut Drive, stamp: FrameStamp, lost: bool) -> Frame {
        let FrameStamp { sequence, captured_at } = stamp;
        match self {
            Self::Jpeg => {
                let bytes = Bytes::from(encode_jpeg(frame, Quality::default()).unwrap());
                if !lost {
                    let message = picture_message(PictureFormat::Jpeg, bytes.clone(), captured_at, CAMERA);
                    drive.record_as(IMAGE_TOPIC, sequence, captured_at, &message, Latch::None);
                }
                decode(&bytes, &DecodeLimits::default()).unwrap()
            }
            Self::Video(codec) => {
                let (encoder, decoder) = &mut **codec;
                let picture = encoder.encode(frame).unwrap();
                let Decoded::Picture(seen) = decoder.decode(&picture.bytes, Vec::new()).unwrap() else {
                    panic!("picture {sequence} waits for a keyframe");
                };
                let latch = if picture.keyframe { Latch::None } else { Latch::Continues };
                let message = foxglove::CompressedVideo {
                    timestamp: foxglove_time(captured_at),
                    frame_id: CAMERA.to_owned(),
                    data: picture.bytes.into(),
                    format: "h264".to_owned(),
                };
                drive.record_as(IMAGE_TOPIC, sequence, captured_at, &message, latch);
                seen
            }
        }
    }
}

/// Where the camera's thread stands, and the results that nobody has recorded yet.
struct Camera {
    follow: Follow,
    late: VecDeque<(Outcome, FollowState)>,
}

impl Camera {
    fn look_at(&mut self, frame: &Frame, stamp: FrameStamp) -> Outcome {
        let outcome = self.follow.on_frame(frame, stamp, &mut NoProbe);
        self.late.push_back((outcome.clone(), self.follow.state().clone()));
        outcome
    }

    /// Records results until only `most` are late.
    fn record(&mut self, drive: &mut Drive, most: usize) {
        while self.late.len() > most {
            let (outcome, state) = self.late.pop_front().unwrap();
            let (sequence, captured_at) = (outcome.sequence, outcome.captured_at);
            let registration = registration_to_wire(CAMERA, &outcome, &[]);
            drive.record("/v2/camera/front/registration", sequence, &registration);
            let state = follow_state_to_wire(CAMERA, self.follow.options(), &state);
            let latch = Latch::Snapshot { key: LatchKey("front".to_owned()), of: IMAGE_TOPIC.into() };
            drive.record_as("/v2/camera/front/follow", sequence, captured_at, &state, latch);
        }
    }
}

/// Another set comes into force.
pub(crate) struct Change {
    /// The picture behind which the set is recorded.
    pub(crate) behind: u64,
    /// The first picture that it is looked for in.
    pub(crate) looked_for_from: u64,
    pub(crate) set: LandmarkSet,
}

/// Follows every picture but each fourth, which a newer one replaces; changes the set half-way and begins a new file
/// after each ninth picture. Results are recorded two pictures late, as a busy thread would.
pub(crate) fn drive(directory: &Path) -> (Vec<PathBuf>, Vec<Outcome>) {
    drive_sending(directory, Coding::Jpeg, None)
}

/// The same drive, in which the recorder may lose one picture that is registered.
pub(crate) fn drive_sending(
    directory: &Path,
    coding: Coding,
    lost: Option<u64>,
) -> (Vec<PathBuf>, Vec<Outcome>) {
    let change = Change {
        behind: FRAMES / 2,
        looked_for_from: FRAMES / 2 + 3,
        set: set(2, vec![landmark("dark", 60.0), landmark("red", 195.0)]),
    };
    drive_changing(directory, coding, lost, &[change])
}

/// The same drive with other changes of the set.
pub(crate) fn drive_changing(
    directory: &Path,
    mut coding: Coding,
    lost: Option<u64>,
    changes: &[Change],
) -> (Vec<PathBuf>, Vec<Outcome>) {
    let journal = Journal::start(JournalOptions::new(directory, "v2")).unwrap();
    let mut drive = Drive { journal, now_ns: 1_700_000_000_000_000_000, in_force: Vec::new() };
    let first = set(1, vec![landmark("red", 200.0)]);
    drive.landmarks(&first);
    let mut camera = Camera { follow: Follow::new(FollowOptions::default(), first), late: VecDeque::new() };
    let mut outcomes: Vec<Outcome> = Vec::new();
    for number in 0..FRAMES {
        let captured_at = Timestamp::from_nanos(1_700_000_000_000_000_000 + number as i64 * 33_333_333);
        let stamp = FrameStamp { sequence: FIRST_SEQUENCE + number, captured_at };
        let frame = coding.send(&picture(number), &mut drive, stamp, lost == Some(number));
        changes
            .iter()
            .filter(|change| change.behind == number)
            .for_each(|change| drive.landmarks(&change.set));
        for change in changes.iter().filter(|change| change.looked_for_from == number) {
            camera.follow.set_landmarks(change.set.clone());
        }
        if number % 4 != 3 {
            outcomes.push(camera.look_at(&frame, stamp));
            camera.record(&mut drive, 2);
            drive.burned_in(&frame, stamp);
        }
        if number % 9 == 8 {
            assert_eq!(drive.journal.command(Command::Split), Offered::Accepted);
        }
    }
    camera.record(&mut drive, 0);
    let report = drive.journal.finish(Duration::from_secs(30));
    assert!(report.in_time);
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    (files, outcomes)
}
