//! Makes the reference recordings: short simulated drives with what was registered in them and what was true.
//!
//! usage: reference_recordings DIRECTORY
//!
//! DIRECTORY receives `rink.mcap` and `stop-sign.mcap`, and beside each its figures, `….expected.json`: the object of
//! `waymark recording report --json`. Topics are those of a follower's recording; every frame is looked at but each
//! eleventh, as if a newer one had replaced it.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use analysis::drive::Drive;
use analysis::figures::Figures;
use analysis::lesson::{FOLLOWER, learn_from};
use recording::{
    Attachment, ChannelSpec, Command, Disk, JournalOptions, Latch, LatchKey, Message, Now, Recorder, Schema,
};
use simulator::{Rendered, SceneKind, SceneOptions, Simulator};
use vision::follow::{Follow, FollowOptions, FrameStamp};
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::{LandmarkSet, NoProbe, SetVersion, SizePx, Timestamp};
use waymark_proto::annotations::annotations;
use waymark_proto::convert::{follow_state_to_wire, landmark_to_wire, manifest_of, registration_to_wire};
use waymark_proto::images::{PictureFormat, picture_message};
use waymark_proto::json::set_to_json;
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;

/// Frame 0 is captured then: 2026-01-01T00:00:00Z.
const START_NS: i64 = 1_767_225_600_000_000_000;
const FRAMES: u64 = 100;
const FRAME_RATE_HZ: f64 = 15.0;
const SIZE: SizePx = SizePx { width: 480, height: 360 };
/// Each so many frames one is not looked at.
const SKIPPED: u64 = 11;
// From capture to receipt, and from there to the result.
const TRANSIT_NS: i64 = 2_000_000;
const WORK_NS: i64 = 9_000_000;
const IMAGE_TOPIC: &str = "/follower/camera/front/image";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [directory] = &arguments[..] else { return Err("usage: reference_recordings DIRECTORY".into()) };
    for scene in [SceneKind::Rink, SceneKind::StopSign] {
        let file = Path::new(directory).join(format!("{scene}.mcap"));
        record(scene, &file)?;
        let figures = Figures::of(&file, &Drive::read(&file)?)?;
        let named = Figures { recording: format!("{scene}.mcap"), ..figures };
        fs::write(file.with_extension("expected.json"), serde_json::to_string_pretty(&named)? + "\n")?;
    }
    Ok(())
}

/// One recorder, and the channels it has met.
struct Drives {
    recorder: Recorder<Disk>,
    channels: Vec<Arc<ChannelSpec>>,
}

/// When something happened.
#[derive(Clone, Copy)]
struct Stamp {
    sequence: u64,
    captured_at: Timestamp,
    received_at_ns: i64,
}

fn record(scene: SceneKind, file: &Path) -> Result<(), Box<dyn Error>> {
    let directory = tempfile::tempdir_in(file.parent().unwrap_or(Path::new(".")))?;
    let options = JournalOptions { free_floor_bytes: 0, ..JournalOptions::new(directory.path(), "follower") };
    let mut recorder = Recorder::new(options, Disk::new(directory.path()))?;
    recorder.command(Command::Start, at(START_NS));
    let mut drives = Drives { recorder, channels: Vec::new() };
    let version = SetVersion { epoch: 1, version: 1 };
    let mut landmarks: Vec<Arc<_>> = learn_from(scene, 1)?.into_iter().map(Arc::new).collect();
    landmarks.sort_by(|a, b| a.id.cmp(&b.id));
    let set = LandmarkSet { version, landmarks };
    drives.landmarks(&set)?;
    let options = SceneOptions {
        vehicle: FOLLOWER,
        size: SIZE,
        frame_rate_hz: FRAME_RATE_HZ,
        frames_one_way: FRAMES as u32,
        ..SceneOptions::new(scene)
    };
    let (mut simulator, mut follow) = (Simulator::new(options)?, Follow::new(FollowOptions::default(), set));
    for index in 0..FRAMES {
        drives.frame(index, &simulator.render(index), &mut follow)?;
    }
    drives.recorder.finish(at(START_NS + 60_000_000_000));
    let made = fs::read_dir(directory.path())?.next().ok_or("nothing was recorded")??;
    Ok(fs::rename(made.path(), file)?)
}

impl Drives {
    fn landmarks(&mut self, set: &LandmarkSet) -> Result<(), Box<dyn Error>> {
        let began = Timestamp::from_nanos(START_NS);
        let stamp = Stamp { sequence: 1, captured_at: began, received_at_ns: START_NS };
        for landmark in &set.landmarks {
            let latch = Latch::Repeat(LatchKey(landmark.id.clone()));
            self.store("/leader/landmark", stamp, &landmark_to_wire(landmark, set.version.epoch), latch);
        }
        let latch = Latch::Repeat(LatchKey("~manifest".to_owned()));
        self.store("/leader/manifest", stamp, &manifest_of(set), latch);
        self.recorder.attach(
            Attachment {
                name: "landmarks.json".to_owned(),
                media_type: "application/json".to_owned(),
                log_time_ns: START_NS as u64,
                data: set_to_json(set)?.into(),
            },
            at(START_NS),
        );
        Ok(())
    }

    fn frame(&mut self, index: u64, rendered: &Rendered, follow: &mut Follow) -> Result<(), Box<dyn Error>> {
        let captured_at = Timestamp::from_nanos(START_NS + rendered.captured_offset_ns);
        let received_at_ns = captured_at.nanos + TRANSIT_NS;
        let stamp = Stamp { sequence: index + 1, captured_at, received_at_ns };
        let jpeg = encode_jpeg(&rendered.frame, Quality::default())?;
        let picture = picture_message(PictureFormat::Jpeg, jpeg.clone().into(), captured_at, "front");
        self.store(IMAGE_TOPIC, stamp, &picture, Latch::None);
        let truth = v1::Truth {
            camera: "front".to_owned(),
            sequence: stamp.sequence,
            captured_at_ns: captured_at.nanos,
            objects: rendered.truth.iter().map(Into::into).collect(),
        };
        self.store("/follower/camera/front/truth", stamp, &truth, Latch::None);
        if index % SKIPPED == SKIPPED - 1 {
            return Ok(());
        }
        let frame = decode(&jpeg, &DecodeLimits::default())?;
        let outcome =
            follow.on_frame(&frame, FrameStamp { sequence: stamp.sequence, captured_at }, &mut NoProbe);
        let late = Stamp { received_at_ns: received_at_ns + WORK_NS, ..stamp };
        let registration = registration_to_wire("front", &outcome, &[]);
        self.store("/follower/camera/front/registration", late, &registration, Latch::None);
        self.store("/follower/camera/front/annotations", late, &annotations(&outcome), Latch::None);
        let state = follow_state_to_wire("front", follow.options(), follow.state());
        let latch = Latch::Snapshot { key: LatchKey("follow".to_owned()), of: IMAGE_TOPIC.into() };
        self.store("/follower/camera/front/follow", late, &state, latch);
        Ok(())
    }

    fn store<M: WireMessage>(&mut self, topic: &str, stamp: Stamp, message: &M, latch: Latch) {
        let message = Message {
            channel: self.channel::<M>(topic),
            log_time_ns: stamp.received_at_ns as u64,
            publish_time_ns: stamp.captured_at.nanos as u64,
            sequence: stamp.sequence as u32,
            data: message.encode_to_vec().into(),
            latch,
        };
        self.recorder.store(vec![message], at(stamp.received_at_ns));
    }

    fn channel<M: WireMessage>(&mut self, topic: &str) -> Arc<ChannelSpec> {
        if let Some(known) = self.channels.iter().find(|channel| channel.topic == topic) {
            return Arc::clone(known);
        }
        let schema =
            Schema { name: M::SCHEMA.to_owned(), file_descriptor_set: M::descriptors().into_owned().into() };
        let key_expression = format!("waymark/v1/reference{topic}");
        let channel = Arc::new(ChannelSpec { topic: topic.to_owned(), key_expression, schema });
        self.channels.push(Arc::clone(&channel));
        channel
    }
}

/// The recorder's clocks at a moment of the drive.
fn at(unix_ns: i64) -> Now {
    Now { elapsed: Duration::from_nanos((unix_ns - START_NS) as u64), unix_ns: unix_ns as u64 }
}
