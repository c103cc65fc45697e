//! A recording registered again says what it said live, frame by frame and field by field.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

use std::collections::BTreeSet;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use analysis::input::Input;
use analysis::register::{Event, Job, Timing, register};
use bytes::Bytes;
use recording::{ChannelSpec, Journal, JournalOptions, Latch, Message, Schema};
use vision::follow::{Follow, FollowOptions, FrameStamp};
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::{
    ColorStats, Digest, Frame, Landmark, LandmarkSet, NoProbe, Outcome, SetVersion, ShapeClass, Timestamp,
    WindowPx,
};
use waymark_proto::convert::{landmark_to_wire, manifest_of, registration_to_wire};
use waymark_proto::digest::landmark_digest;
use waymark_proto::images::{PictureFormat, picture_message};
use waymark_proto::payload::WireMessage;

const CAMERA: &str = "front";
const FRAMES: u64 = 24;
/// Begins beyond 32 bits: MCAP keeps only the low half of a sequence number.
const FIRST_SEQUENCE: u64 = (1 << 32) + 5;

/// A red square on grey that moves to the right.
fn picture(number: u64) -> Bytes {
    let (left, top) = (20 + 2 * number as u32, 30);
    let square = |x: u32, y: u32| (left..left + 18).contains(&x) && (top..top + 18).contains(&y);
    let colour =
        |x: u32, y: u32| if square(x, y) { [200, 40, 30] } else { [(90 + (x * 7 + y * 13) % 23) as u8; 3] };
    let rgb = (0..96).flat_map(|y| (0..128).flat_map(move |x| colour(x, y))).collect();
    let frame = Frame::from_rgb(128, 96, rgb).unwrap();
    encode_jpeg(&frame, Quality::default()).unwrap().into()
}

fn landmark(id: &str, red: f32) -> Arc<Landmark> {
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

fn set(version: u64, landmarks: Vec<Arc<Landmark>>) -> LandmarkSet {
    LandmarkSet { version: SetVersion { epoch: 3, version }, landmarks }
}

struct Drive {
    journal: Journal,
    now_ns: u64,
}

impl Drive {
    fn record<M: WireMessage>(&mut self, topic: &str, sequence: u64, message: &M) {
        self.now_ns += 1_000_000;
        let schema =
            Schema { name: M::SCHEMA.to_owned(), file_descriptor_set: M::descriptors().into_owned().into() };
        let channel =
            Arc::new(ChannelSpec { topic: topic.to_owned(), key_expression: String::new(), schema });
        let _counted = self.journal.offer(Message {
            channel,
            log_time_ns: self.now_ns,
            publish_time_ns: self.now_ns,
            sequence: sequence as u32,
            data: message.encode_to_vec().into(),
            latch: Latch::None,
        });
    }

    fn landmarks(&mut self, set: &LandmarkSet) {
        for landmark in &set.landmarks {
            self.record(
                "/lead/landmark",
                set.version.version,
                &landmark_to_wire(landmark, set.version.epoch),
            );
        }
        self.record("/lead/manifest", set.version.version, &manifest_of(set));
    }
}

/// Follows every picture but each fourth, which a newer one replaces; changes the set half-way. Each result is
/// recorded one picture late, as a busy thread would.
fn drive(directory: &Path) -> (PathBuf, Vec<Outcome>) {
    let journal = Journal::start(JournalOptions::new(directory, "v2")).unwrap();
    let mut drive = Drive { journal, now_ns: 1_700_000_000_000_000_000 };
    let sets =
        [set(1, vec![landmark("red", 200.0)]), set(2, vec![landmark("dark", 60.0), landmark("red", 195.0)])];
    drive.landmarks(&sets[0]);
    let mut follow = Follow::new(FollowOptions::default(), sets[0].clone());
    let mut outcomes: Vec<Outcome> = Vec::new();
    let mut late: Option<Outcome> = None;
    for number in 0..FRAMES {
        let (sequence, bytes) = (FIRST_SEQUENCE + number, picture(number));
        let captured_at = Timestamp::from_nanos(1_700_000_000_000_000_000 + number as i64 * 33_333_333);
        let message = picture_message(PictureFormat::Jpeg, bytes.clone(), captured_at, CAMERA);
        drive.record("/v2/camera/front/image", sequence, &message);
        if number == FRAMES / 2 {
            drive.landmarks(&sets[1]);
        }
        if number == FRAMES / 2 + 3 {
            follow.set_landmarks(sets[1].clone());
        }
        if number % 4 != 3 {
            let frame = decode(&bytes, &DecodeLimits::default()).unwrap();
            let outcome = follow.on_frame(&frame, FrameStamp { sequence, captured_at }, &mut NoProbe);
            outcomes.push(outcome.clone());
            if let Some(earlier) = late.replace(outcome) {
                drive.record(
                    "/v2/camera/front/registration",
                    earlier.sequence,
                    &registration_to_wire(CAMERA, &earlier),
                );
            }
        }
    }
    let last = late.unwrap();
    drive.record("/v2/camera/front/registration", last.sequence, &registration_to_wire(CAMERA, &last));
    let report = drive.journal.finish(Duration::from_secs(30));
    assert!(report.in_time);
    let file = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    (file.into_iter().find(|path| path.extension().is_some_and(|e| e == "mcap")).unwrap(), outcomes)
}

fn replayed(input: &str, landmarks: Option<Arc<LandmarkSet>>) -> (Vec<u64>, Vec<Outcome>) {
    let input = Input::parse(input).unwrap();
    let frames = input.open().unwrap();
    let job = Job {
        landmarks,
        options: FollowOptions::default(),
        threads: NonZeroUsize::MIN,
        timing: Timing::Off,
        overlays: None,
    };
    let (mut numbers, mut outcomes) = (Vec::new(), Vec::new());
    let done = register(vec![(input, frames)], &job, |_, event| -> Result<(), Infallible> {
        let Event::Registered { frame, camera, outcome } = event else { panic!("{event:?}") };
        assert_eq!(camera.as_deref(), Some(CAMERA));
        numbers.push(frame);
        outcomes.push(outcome);
        Ok(())
    });
    done.unwrap();
    (numbers, outcomes)
}

#[test]
fn live_outcomes_are_replayed_in_every_field() {
    let directory = tempfile::tempdir().unwrap();
    let (file, live) = drive(directory.path());
    assert!(live.iter().any(|outcome| outcome.landmarks.iter().any(|landmark| landmark.result.is_ok())));
    let (numbers, outcomes) = replayed(file.to_str().unwrap(), None);
    assert_eq!(outcomes, live);
    let dropped: Vec<u64> = (1..=FRAMES).filter(|number| !numbers.contains(number)).collect();
    assert_eq!(dropped, [4, 8, 12, 16, 20, 24], "frames that nobody looked at live");
    let versions: BTreeSet<u64> = outcomes.iter().map(|outcome| outcome.set_version.version).collect();
    assert_eq!(versions, BTreeSet::from([1, 2]));
}

#[test]
fn other_landmarks_are_looked_for_in_every_frame() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = drive(directory.path());
    let given = Arc::new(set(0, vec![landmark("other", 200.0)]));
    let input = format!("mcap:{}#/v2/camera/front/image", file.display());
    let (numbers, outcomes) = replayed(&input, Some(given));
    assert_eq!(numbers, (1..=FRAMES).collect::<Vec<_>>());
    assert!(outcomes.iter().all(|outcome| outcome.landmarks[0].landmark == "other"));
}

#[test]
fn a_topic_that_is_not_there_is_answered_with_those_that_are() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = drive(directory.path());
    let input = Input::parse(&format!("mcap:{}#/v2/camera/rear/image", file.display())).unwrap();
    let Err(error) = input.open() else { panic!("opened") };
    let error = error.to_string();
    assert!(error.ends_with("its image topics are /v2/camera/front/image"), "{error}");
}
