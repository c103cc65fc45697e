//! `waymark recording`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use recording::{ChannelSpec, Journal, JournalOptions, Latch, Message, Schema};
use serde_json::Value;
use vision::Timestamp;
use vision::frame::encode::{Quality, encode_jpeg};
use waymark_proto::foxglove::CompressedImage;
use waymark_proto::images::{PictureFormat, picture_message};
use waymark_proto::payload::WireMessage;

use crate::program::waymark;
use crate::scene::{Drive, frame, text};

const TOPIC: &str = "/v2/camera/front/image";

fn encoded<M: WireMessage>(message: &M) -> Vec<u8> {
    message.encode_to_vec()
}

/// A recording of `frames` pictures, 100 ms apart.
fn recorded(directory: &Path, frames: u32) -> PathBuf {
    let journal = Journal::start(JournalOptions::new(directory, "v2")).unwrap();
    let schema = Schema {
        name: CompressedImage::SCHEMA.to_owned(),
        file_descriptor_set: CompressedImage::descriptors().into_owned().into(),
    };
    let channel = Arc::new(ChannelSpec { topic: TOPIC.to_owned(), key_expression: "key".to_owned(), schema });
    for number in 1..=frames {
        let captured_at = Timestamp::from_nanos(1_700_000_000_000_000_000 + i64::from(number) * 100_000_000);
        let jpeg = encode_jpeg(&frame(number), Quality::default()).unwrap();
        let image = picture_message(PictureFormat::Jpeg, jpeg.into(), captured_at, "front");
        let _counted = journal.offer(Message {
            channel: Arc::clone(&channel),
            log_time_ns: captured_at.nanos as u64,
            publish_time_ns: captured_at.nanos as u64,
            sequence: number,
            data: encoded(&image).into(),
            latch: Latch::None,
        });
    }
    assert!(journal.finish(Duration::from_secs(30)).in_time);
    let mut files = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    files.find(|path| path.extension().is_some_and(|extension| extension == "mcap")).unwrap()
}

#[test]
fn a_recording_says_what_it_holds() {
    let directory = tempfile::tempdir().unwrap();
    let file = recorded(directory.path(), 11);
    let info = waymark(["recording", "info", text(&file)]).ended(0).stdout;
    let line = info.lines().find(|line| line.contains(TOPIC)).unwrap();
    let cells: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(cells[1..4], ["foxglove.CompressedImage", "11", "10.0"], "{info}");
    let json = waymark(["recording", "info", "--json", text(&file)]).ended(0).stdout;
    let info: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(info["topics"][0]["messages"], 11);
    assert_eq!(info["topics"][0]["lost"], 0);
}

#[test]
fn a_whole_recording_passes_its_check_and_a_cut_one_is_recovered() {
    let directory = tempfile::tempdir().unwrap();
    let file = recorded(directory.path(), 30);
    waymark(["recording", "check", text(&file)]).ended(0);
    let cut = directory.path().join("cut.mcap.active");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let found = waymark(["recording", "check", text(&cut)]).ended(1).stdout;
    assert!(found.contains("damaged"), "{found}");
    let out = directory.path().join("recovered.mcap");
    waymark(["recording", "recover", text(&cut), "-o", text(&out)]).ended(3);
    let found = waymark(["recording", "check", text(&out)]).ended(3).stdout;
    assert!(found.contains("valid, but data was lost"), "{found}");
    waymark(["recording", "recover", text(&cut), "-o", text(&out)]).ended(2).telling("exists already");
}

#[test]
fn a_recording_is_registered_like_its_pictures() {
    let directory = tempfile::tempdir().unwrap();
    let file = recorded(directory.path(), 5);
    let drive = Drive::of(5);
    let with_landmark = |input: &str| {
        let csv = waymark(["register", input, "--landmark", text(&drive.landmark())]).ended(0).stdout;
        let found: Vec<String> = csv
            .lines()
            .skip(1)
            .map(|line| line.split(',').skip(7).take(3).collect::<Vec<_>>().join(" "))
            .collect();
        found
    };
    assert_eq!(with_landmark(text(&file)), with_landmark(text(&drive.frames())));
    waymark(["register", text(&file)]).ended(2).telling("brings no landmarks");
}

#[test]
fn what_is_no_recording_is_refused() {
    let drive = Drive::of(1);
    for command in ["info", "check"] {
        waymark(["recording", command, text(&drive.landmark())]).ended(2).telling("MCAP");
    }
}
