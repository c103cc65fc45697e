//! A camera that sends video, seen through a Zenoh session: each message is decoded, and a gap is waited out.

#![allow(clippy::unwrap_used)] // a test's helpers may fail the test

use std::net::TcpListener;
use std::time::Duration;

use camera::{CameraConfig, H264Config, SentEncoding};
use ingest::camera_decoder::{CameraDecoder, Undecoded};
use ingest::encoded::{EncodedFrame, Encoding};
use ingest::picture_message::PictureKind;
use runtime::{SessionSettings, Shutdown};
use simulator::Simulator;
use tokio::sync::mpsc;
use tokio::time::timeout;
use vision::Frame;
use waymark_proto::attachment::Attachment;

/// Longer than anything takes, even on a busy machine.
const LONG: Duration = Duration::from_secs(60);
const SCENE: &str = "sim:rink?seed=3";
const PICTURES: usize = 14;

/// The first messages of a camera, as a follower reads them.
async fn messages() -> Vec<EncodedFrame> {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let session = SessionSettings::router(&endpoint).open().await.unwrap();
    let (sender, mut received) = mpsc::channel(64);
    let _subscriber = session
        .declare_subscriber("waymark/v1/convoy/follower/camera/front/image")
        .callback(move |sample| {
            let schema = sample.encoding().to_string();
            let kind = PictureKind::of_schema(schema.rsplit(';').next().unwrap()).unwrap();
            let attachment = Attachment::from_bytes(&sample.attachment().unwrap().to_bytes()).unwrap();
            let picture = kind.read(attachment.sequence as u64, &sample.payload().to_bytes()).unwrap();
            // Later ones are not wanted.
            let _enough = sender.try_send(picture);
        })
        .await
        .unwrap();
    let config = CameraConfig {
        source: SCENE.to_owned(),
        encoding: SentEncoding::H264,
        h264: H264Config { quantizer: 20, keyframe_interval: 5 },
        ..CameraConfig::default()
    };
    let shutdown = Shutdown::default();
    let camera = tokio::spawn(camera::run(config, session.clone(), shutdown.clone()));
    let mut messages = Vec::new();
    while messages.len() < PICTURES {
        messages.push(timeout(LONG, received.recv()).await.unwrap().unwrap());
    }
    shutdown.request();
    camera.await.unwrap().unwrap();
    messages
}

fn mean_difference(a: &Frame, b: &Frame) -> f64 {
    assert_eq!(a.size(), b.size());
    let sum: u64 = a.rgb().iter().zip(b.rgb()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.rgb().len() as f64
}

#[tokio::test(flavor = "multi_thread")]
async fn what_the_simulator_renders_is_what_a_receiver_decodes() {
    let messages = messages().await;
    let mut simulator = Simulator::new(SCENE.parse().unwrap()).unwrap();
    let mut decoder = CameraDecoder::default();
    for (number, message) in (0..).zip(&messages) {
        assert_eq!(
            (message.encoding.clone(), message.sequence),
            (Encoding::H264, messages[0].sequence + number)
        );
        let frame = decoder.decode_into(message, Vec::new()).unwrap();
        let difference = mean_difference(&frame, &simulator.render(number).frame);
        assert!(difference < 6.0, "picture {number} differs by {difference} levels");
    }
    waits_out_a_gap(&messages);
}

fn waits_out_a_gap(messages: &[EncodedFrame]) {
    let mut decoder = CameraDecoder::default();
    let decoded: Vec<bool> = messages
        .iter()
        .enumerate()
        .filter(|(number, _)| *number != 6)
        .map(|(_, message)| match decoder.decode_into(message, Vec::new()) {
            Ok(_) => true,
            Err(Undecoded::AwaitingKeyframe) => false,
            Err(error) => panic!("{error}"),
        })
        .collect();
    let mut expected = vec![true; PICTURES - 1];
    // Pictures 7, 8 and 9 need the missing one; 10 begins anew.
    expected[6..9].fill(false);
    assert_eq!(decoded, expected);
}
