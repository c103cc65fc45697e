//! A recording registered again says what it said live, frame by frame and field by field.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use analysis::again::{AgainError, AgainWriter};
use analysis::diff::{DiffTally, changes};
use analysis::follow_choice::FollowChoice;
use analysis::input::{Input, Past};
use analysis::recorded::RecordedOutcomes;
use analysis::register::{Event, Job, Timing, register};
use bytes::Bytes;
use recording::check::{Verdict, check};
use recording::reader::{MessageReader, Strictness};
use recording::{ChannelSpec, Command, Journal, JournalOptions, Latch, LatchKey, Message, Offered, Schema};
use vision::follow::{Follow, FollowOptions, FollowState, FrameStamp, Mode};
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::{
    ColorStats, Digest, Frame, Landmark, LandmarkSet, NoProbe, Outcome, SetVersion, ShapeClass, Timestamp,
    WindowPx,
};
use waymark_proto::convert::{follow_state_to_wire, landmark_to_wire, manifest_of, registration_to_wire};
use waymark_proto::digest::landmark_digest;
use waymark_proto::images::{PictureFormat, picture_message};
use waymark_proto::payload::WireMessage;

const CAMERA: &str = "front";
const IMAGE_TOPIC: &str = "/v2/camera/front/image";
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

    fn landmarks(&mut self, set: &LandmarkSet) {
        let SetVersion { epoch, version } = set.version;
        let now = Timestamp::from_nanos(self.now_ns as i64);
        for landmark in &set.landmarks {
            let latch = Latch::Repeat(LatchKey(landmark.id.clone()));
            self.record_as("/lead/landmark", version, now, &landmark_to_wire(landmark, epoch), latch);
        }
        // The last of a head, as its key sorts behind every landmark's.
        let latch = Latch::Repeat(LatchKey("~manifest".to_owned()));
        self.record_as("/lead/manifest", version, now, &manifest_of(set), latch);
    }
}

/// Where the camera's thread stands, and the results that nobody has recorded yet.
struct Camera {
    follow: Follow,
    late: VecDeque<(Outcome, FollowState)>,
}

impl Camera {
    fn look_at(&mut self, sequence: u64, captured_at: Timestamp, bytes: &[u8]) -> Outcome {
        let frame = decode(bytes, &DecodeLimits::default()).unwrap();
        let outcome = self.follow.on_frame(&frame, FrameStamp { sequence, captured_at }, &mut NoProbe);
        self.late.push_back((outcome.clone(), self.follow.state()));
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

/// Follows every picture but each fourth, which a newer one replaces; changes the set half-way and begins a new file
/// after each ninth picture. Results are recorded two pictures late, as a busy thread would.
fn drive(directory: &Path) -> (Vec<PathBuf>, Vec<Outcome>) {
    drive_losing(directory, None)
}

/// The same drive, in which the recorder loses one picture that is registered.
fn drive_losing(directory: &Path, lost: Option<u64>) -> (Vec<PathBuf>, Vec<Outcome>) {
    let journal = Journal::start(JournalOptions::new(directory, "v2")).unwrap();
    let mut drive = Drive { journal, now_ns: 1_700_000_000_000_000_000 };
    let sets =
        [set(1, vec![landmark("red", 200.0)]), set(2, vec![landmark("dark", 60.0), landmark("red", 195.0)])];
    drive.landmarks(&sets[0]);
    let mut camera =
        Camera { follow: Follow::new(FollowOptions::default(), sets[0].clone()), late: VecDeque::new() };
    let mut outcomes: Vec<Outcome> = Vec::new();
    for number in 0..FRAMES {
        let (sequence, bytes) = (FIRST_SEQUENCE + number, picture(number));
        let captured_at = Timestamp::from_nanos(1_700_000_000_000_000_000 + number as i64 * 33_333_333);
        let message = picture_message(PictureFormat::Jpeg, bytes.clone(), captured_at, CAMERA);
        if lost != Some(number) {
            drive.record_as(IMAGE_TOPIC, sequence, captured_at, &message, Latch::None);
        }
        if number == FRAMES / 2 {
            drive.landmarks(&sets[1]);
        }
        if number == FRAMES / 2 + 3 {
            camera.follow.set_landmarks(sets[1].clone());
        }
        if number % 4 != 3 {
            outcomes.push(camera.look_at(sequence, captured_at, &bytes));
            camera.record(&mut drive, 2);
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

fn replayed(input: &str, landmarks: Option<Arc<LandmarkSet>>) -> (Vec<u64>, Vec<Outcome>) {
    replayed_as(input, landmarks, FollowChoice::default())
}

fn replayed_as(
    input: &str,
    landmarks: Option<Arc<LandmarkSet>>,
    choice: FollowChoice,
) -> (Vec<u64>, Vec<Outcome>) {
    let frames = frames_of(input, landmarks, choice).into_iter();
    frames
        .map(|frame| {
            assert_ne!(frame.recorded, Some(Past::Missing));
            (frame.number, frame.outcome)
        })
        .unzip()
}

struct Replayed {
    number: u64,
    outcome: Outcome,
    recorded: Option<Past>,
}

fn frames_of(input: &str, landmarks: Option<Arc<LandmarkSet>>, choice: FollowChoice) -> Vec<Replayed> {
    let input = Input::parse(input).unwrap();
    let frames = input.open().unwrap();
    let job = Job { landmarks, choice, threads: NonZeroUsize::MIN, timing: Timing::Off, overlays: None };
    let mut replayed = Vec::new();
    let done = register(vec![(input, frames)], &job, |_, event| -> Result<(), Infallible> {
        let Event::Registered { frame, camera, outcome, recorded, .. } = event else { panic!("{event:?}") };
        assert_eq!(camera.as_deref(), Some(CAMERA));
        replayed.push(Replayed { number: frame, outcome, recorded });
        Ok(())
    });
    done.unwrap();
    replayed
}

/// Compares a file with itself registered again.
fn compared(file: &Path, choice: FollowChoice) -> DiffTally {
    let mut recorded = RecordedOutcomes::open(file, None).unwrap();
    let mut tally = DiffTally::default();
    for frame in frames_of(file.to_str().unwrap(), None, choice) {
        let (captured_at, sequence) = (frame.outcome.captured_at, frame.outcome.sequence);
        let live = recorded.take(CAMERA, captured_at, sequence).unwrap().unwrap();
        tally.count(frame.recorded.unwrap(), &changes(&live, &frame.outcome));
    }
    tally
}

#[test]
fn a_comparison_finds_nothing_where_nothing_changed_and_something_where_it_did() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let same = compared(&files[1], FollowChoice::default());
    assert_eq!((same.compared, same.different, same.fields.len()), (5, 0, 0), "{same:?}");
    let faithful = FollowChoice { mode: Some(Mode::Faithful), ..FollowChoice::default() };
    let changed = compared(&files[1], faithful);
    assert_eq!(changed.different, changed.compared);
    assert!(changed.fields["gain"].changes > 0, "{changed:?}");
}

#[test]
fn frames_behind_a_lost_picture_are_told_apart_until_the_next_state() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive_losing(directory.path(), Some(12));
    let tallies: Vec<DiffTally> = files.iter().map(|file| compared(file, FollowChoice::default())).collect();
    assert_eq!(tallies.iter().map(|tally| tally.different).collect::<Vec<_>>(), [0, 0, 0]);
    assert_eq!((tallies[0].without_past, tallies[2].without_past), (0, 0));
    assert!(tallies[1].without_past > 0 && tallies[1].compared > 0, "{:?}", tallies[1]);
}

#[test]
fn a_recording_written_again_has_the_old_and_the_new() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let output = directory.path().join("again.mcap");
    let mut again = AgainWriter::begin(&files[1], &output, None).unwrap();
    let camera = Arc::from(CAMERA);
    let frames = frames_of(files[1].to_str().unwrap(), None, FollowChoice::default());
    for frame in &frames {
        again.add(frame.number, &camera, &frame.outcome, &[]).unwrap();
    }
    again.finish(BTreeMap::new(), None).unwrap();
    let read = |path: &Path| -> Vec<_> {
        MessageReader::open(path, Strictness::Strict).unwrap().map(Result::unwrap).collect()
    };
    let (new, old): (Vec<_>, Vec<_>) =
        read(&output).into_iter().partition(|message| message.channel.topic.ends_with("/again"));
    assert_eq!(old, read(&files[1]));
    assert_eq!(new.len(), 2 * frames.len());
    assert_eq!(check(&output).unwrap().verdict(), Verdict::Fine);
    let registered: Vec<Outcome> = frames.into_iter().map(|frame| frame.outcome).collect();
    assert_eq!(replayed(output.to_str().unwrap(), None).1, registered);
    let twice = AgainWriter::begin(&output, &directory.path().join("twice.mcap"), None).unwrap();
    assert!(matches!(twice.finish(BTreeMap::new(), None), Err(AgainError::Twice { .. })));
}

#[test]
fn each_file_of_a_series_alone_replays_what_was_live_in_every_field() {
    let directory = tempfile::tempdir().unwrap();
    let (files, live) = drive(directory.path());
    assert_eq!(files.len(), 3);
    assert!(live.iter().all(|outcome| outcome.landmarks.iter().any(|landmark| landmark.result.is_ok())));
    let replays = files.iter().map(|file| replayed(file.to_str().unwrap(), None));
    let outcomes: Vec<Outcome> = replays.flat_map(|(_, outcomes)| outcomes).collect();
    // A result that came after its picture's file had ended belongs to no file.
    let apart = [6, 8, 16, 17].map(|number| FIRST_SEQUENCE + number);
    let expected: Vec<Outcome> =
        live.into_iter().filter(|outcome| !apart.contains(&outcome.sequence)).collect();
    let sequences = |outcomes: &[Outcome]| outcomes.iter().map(|o| o.sequence).collect::<Vec<_>>();
    assert_eq!(sequences(&outcomes), sequences(&expected));
    for (replayed, live) in outcomes.iter().zip(&expected) {
        assert_eq!(replayed, live);
    }
    let versions: BTreeSet<u64> = outcomes.iter().map(|outcome| outcome.set_version.version).collect();
    assert_eq!(versions, BTreeSet::from([1, 2]));
}

#[test]
fn another_way_of_following_has_a_past_of_its_own() {
    let directory = tempfile::tempdir().unwrap();
    let (files, live) = drive(directory.path());
    let choice = FollowChoice { mode: Some(Mode::Faithful), ..FollowChoice::default() };
    let (_, outcomes) = replayed_as(files[1].to_str().unwrap(), None, choice);
    let first = outcomes[0].clone();
    let landmark = &first.landmarks[0];
    assert!(landmark.prediction.is_none() && landmark.adaptation.is_none(), "{landmark:?}");
    assert!(!live.contains(&first));
}

#[test]
fn other_landmarks_are_looked_for_in_every_frame() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let given = Arc::new(set(0, vec![landmark("other", 200.0)]));
    let input = format!("mcap:{}#/v2/camera/front/image", files[0].display());
    let (numbers, outcomes) = replayed(&input, Some(given));
    assert_eq!(numbers, (1..=9).collect::<Vec<_>>());
    assert!(outcomes.iter().all(|outcome| outcome.landmarks[0].landmark == "other"));
}

#[test]
fn a_topic_that_is_not_there_is_answered_with_those_that_are() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let input = Input::parse(&format!("mcap:{}#/v2/camera/rear/image", files[0].display())).unwrap();
    let Err(error) = input.open() else { panic!("opened") };
    let error = error.to_string();
    assert!(error.ends_with("its image topics are /v2/camera/front/image"), "{error}");
}
