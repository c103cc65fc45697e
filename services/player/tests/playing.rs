//! Recordings played over real Zenoh sessions.

#![allow(clippy::unwrap_used)] // a test's helpers may fail the test

use std::net::TcpListener;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use player::tempo::Rate;
use player::{Command, PlayOptions, play};
use recording::{ChannelSpec, Journal, JournalOptions, Latch, LatchKey, Message, Schema};
use runtime::SessionSettings;
use tempfile::TempDir;
use tokio::sync::mpsc;
use tokio::time::timeout;
use waymark_proto::attachment::Attachment;
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;

/// Longer than anything takes, even on a busy machine.
const LONG: Duration = Duration::from_secs(60);
const IMAGE_KEY: &str = "waymark/v1/convoy/a/camera/front/image";
const LANDMARK_KEY: &str = "waymark/v1/convoy/lead/landmark/**";
const STEP_NS: u64 = 10_000_000;
const BEGIN_NS: u64 = 1_700_000_000_000_000_000;

fn channel(topic: &str, key: &str, schema: &str) -> Arc<ChannelSpec> {
    Arc::new(ChannelSpec {
        topic: topic.to_owned(),
        key_expression: key.to_owned(),
        schema: Schema {
            name: schema.to_owned(),
            file_descriptor_set: Bytes::from(v1::Landmark::descriptors().into_owned()),
        },
    })
}

/// A recording of 50 pictures, 10 ms apart, number 20 lost, and of a landmark that was published before them.
fn recording(directory: &TempDir) -> PathBuf {
    let options = JournalOptions { free_floor_bytes: 0, ..JournalOptions::new(directory.path(), "a") };
    let journal = Journal::start(options).unwrap();
    let (landmarks, images) = (
        channel("/lead/landmark", LANDMARK_KEY, v1::Landmark::SCHEMA),
        channel("/a/camera/front/image", IMAGE_KEY, "foxglove.CompressedImage"),
    );
    // Field 1 of a landmark is its id.
    let landmark = Message {
        channel: landmarks,
        log_time_ns: BEGIN_NS,
        publish_time_ns: BEGIN_NS,
        sequence: 1,
        data: Bytes::from_static(b"\x0a\x03red"),
        latch: Latch::Repeat(LatchKey("red".to_owned())),
    };
    journal.offer(landmark);
    for number in (1..=50_u32).filter(|number| *number != 20) {
        let log_time_ns = BEGIN_NS + u64::from(number) * STEP_NS;
        let data = Bytes::from(format!("picture {number}"));
        let channel = Arc::clone(&images);
        let publish_time_ns = log_time_ns - 500;
        journal.offer(Message {
            channel,
            log_time_ns,
            publish_time_ns,
            sequence: number,
            data,
            latch: Latch::None,
        });
    }
    assert_eq!(journal.finish(LONG).ledger.total().lost(), 0);
    let mut files = std::fs::read_dir(directory.path()).unwrap().map(|entry| entry.unwrap().path());
    files.find(|path| path.extension().is_some_and(|extension| extension == "mcap")).unwrap()
}

/// What a subscriber of everything received.
#[derive(Debug)]
struct Received {
    key: String,
    payload: Vec<u8>,
    encoding: String,
    attachment: Attachment,
}

struct Listener {
    session: zenoh::Session,
    samples: mpsc::Receiver<Received>,
    _subscriber: zenoh::pubsub::Subscriber<()>,
}

impl Listener {
    async fn open() -> Self {
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let session = SessionSettings::router(&format!("tcp/127.0.0.1:{port}")).open().await.unwrap();
        let (sender, samples) = mpsc::channel(1024);
        let subscriber = session
            .declare_subscriber("waymark/**")
            .callback(move |sample| {
                let received = Received {
                    key: sample.key_expr().to_string(),
                    payload: sample.payload().to_bytes().into_owned(),
                    encoding: sample.encoding().to_string(),
                    attachment: Attachment::from_bytes(&sample.attachment().unwrap().to_bytes()).unwrap(),
                };
                // The channel holds more than any test plays.
                let _full = sender.try_send(received);
            })
            .await
            .unwrap();
        Self { session, samples, _subscriber: subscriber }
    }

    async fn next(&mut self) -> Received {
        timeout(LONG, self.samples.recv()).await.unwrap().unwrap()
    }
}

fn options(file: PathBuf) -> PlayOptions {
    PlayOptions {
        files: vec![file],
        rate: Rate::new(0.0).unwrap(),
        start: Duration::ZERO,
        repeat: false,
        paused: false,
        remaps: Vec::new(),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn everything_is_published_as_it_was_recorded() {
    let directory = tempfile::tempdir().unwrap();
    let mut listener = Listener::open().await;
    let options = PlayOptions { rate: Rate::RECORDED, ..options(recording(&directory)) };
    let (_control, thread) = play(options, listener.session.clone()).unwrap();
    let landmark = listener.next().await;
    assert_eq!(landmark.key, "waymark/v1/convoy/lead/landmark/red");
    assert_eq!(landmark.encoding, "application/protobuf;waymark.v1.Landmark");
    for (position, number) in (1..=50).filter(|number| *number != 20).enumerate() {
        let received = listener.next().await;
        assert_eq!(received.key, IMAGE_KEY);
        assert_eq!(received.payload, format!("picture {number}").as_bytes());
        assert_eq!(received.attachment.source_time_ns as u64, BEGIN_NS + number * STEP_NS - 500);
        // The gap of the recording is a gap again.
        assert_eq!(received.attachment.sequence as u64, number, "at {position}");
    }
    let report = tokio::task::spawn_blocking(|| thread.join()).await.unwrap().unwrap().unwrap();
    assert_eq!((report.status.published, report.status.rounds), (50, 0));
    let mut lateness = report.lateness_ns;
    lateness.sort_unstable();
    eprintln!(
        "lateness p50 {} us, p99 {} us",
        lateness[lateness.len() / 2] / 1000,
        lateness[lateness.len() * 99 / 100] / 1000
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_start_in_the_middle_knows_the_landmarks() {
    let directory = tempfile::tempdir().unwrap();
    let mut listener = Listener::open().await;
    let remaps = vec!["waymark/v1/convoy/a=waymark/v1/convoy/ghost".parse().unwrap()];
    let start = Duration::from_millis(300);
    let options = PlayOptions { start, remaps, repeat: true, ..options(recording(&directory)) };
    let (control, thread) = play(options, listener.session.clone()).unwrap();
    for round in 0..2 {
        let landmark = listener.next().await;
        assert_eq!(landmark.key, "waymark/v1/convoy/lead/landmark/red", "round {round}");
        for number in 30..=50 {
            let received = listener.next().await;
            assert_eq!(received.key, "waymark/v1/convoy/ghost/camera/front/image");
            assert_eq!(received.payload, format!("picture {number}").as_bytes());
            // 21 pictures a round, and a gap between rounds, which decoders of video must notice.
            let before = i64::from(round) * 22;
            assert_eq!(received.attachment.sequence, before + i64::from(number) - 29);
        }
    }
    assert!(control.ask(Command::Stop));
    let report = tokio::task::spawn_blocking(|| thread.join()).await.unwrap().unwrap().unwrap();
    assert!(report.status.rounds >= 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn it_waits_seeks_and_goes_on_when_told() {
    let directory = tempfile::tempdir().unwrap();
    let mut listener = Listener::open().await;
    let options = PlayOptions { paused: true, ..options(recording(&directory)) };
    let (control, thread) = play(options, listener.session.clone()).unwrap();
    assert!(control.ask(Command::Seek(Duration::from_millis(480))));
    // The state of the new place comes even while it is paused; pictures do not.
    assert_eq!(listener.next().await.key, "waymark/v1/convoy/lead/landmark/red");
    assert!(control.ask(Command::Resume));
    for number in 48..=50 {
        assert_eq!(listener.next().await.payload, format!("picture {number}").as_bytes());
    }
    tokio::task::spawn_blocking(|| thread.join()).await.unwrap().unwrap().unwrap();
    assert!(!control.ask(Command::Pause), "it has ended");
    let last = control.status();
    assert!(!last.paused && (last.position_s - 0.5).abs() < 1e-6, "{last:?}");
}

/// Five seconds of a 1280×720 camera at 30 pictures a second, 150 kB each; how fast is printed, not judged.
#[tokio::test(flavor = "multi_thread")]
async fn at_full_speed_nothing_is_left_out() {
    const PICTURES: u32 = 150;
    let directory = tempfile::tempdir().unwrap();
    let options_of_journal =
        JournalOptions { free_floor_bytes: 0, ..JournalOptions::new(directory.path(), "a") };
    let journal = Journal::start(options_of_journal).unwrap();
    let images = channel("/a/camera/front/image", IMAGE_KEY, "foxglove.CompressedImage");
    for number in 1..=PICTURES {
        let log_time_ns = BEGIN_NS + u64::from(number) * 33_333_333;
        let data: Bytes = (0..150_000_u32).map(|at| (at.wrapping_mul(number) >> 7) as u8).collect();
        let channel = Arc::clone(&images);
        journal.offer(Message {
            channel,
            log_time_ns,
            publish_time_ns: log_time_ns,
            sequence: number,
            data,
            latch: Latch::None,
        });
    }
    assert_eq!(journal.finish(LONG).ledger.total().lost(), 0);
    let file = std::fs::read_dir(directory.path()).unwrap().next().unwrap().unwrap().path();
    let mut listener = Listener::open().await;
    let begun = std::time::Instant::now();
    let (_control, thread) = play(options(file), listener.session.clone()).unwrap();
    for number in 1..=PICTURES {
        assert_eq!(listener.next().await.attachment.sequence, i64::from(number));
    }
    eprintln!("{:.1} times real time", 5.0 / begun.elapsed().as_secs_f64());
    tokio::task::spawn_blocking(|| thread.join()).await.unwrap().unwrap().unwrap();
}
