//! Live streams: each message gives its picture at once, and a gap is waited out.

use video::access_unit::{NalKind, nal_units};
use video::stream::is_keyframe;
use video::{Decoded, StreamDecoder, StreamEncoder, VideoError};
use vision::Frame;
use vision::frame::decode::DecodeLimits;

use crate::pictures::{OPTIONS, difference, moving, square_left, stream};

#[test]
fn every_message_gives_its_picture_at_once() {
    let mut decoder = StreamDecoder::new(DecodeLimits::default());
    for (number, message) in (0..).zip(stream(20)) {
        let Decoded::Picture(frame) = decoder.decode(&message, Vec::new()).unwrap() else {
            panic!("{number}")
        };
        let sent = moving(160, 96, number);
        assert!(square_left(&frame).abs_diff(square_left(&sent)) <= 1, "picture {number}");
        let difference = difference(&frame, &sent);
        assert!(difference < 4.0, "picture {number} differs by {difference}");
    }
}

#[test]
fn each_keyframe_brings_its_parameter_sets() {
    let messages = stream(17);
    let kinds = |message: &[u8]| nal_units(message).map(NalKind::of).collect::<Vec<_>>();
    for (number, message) in messages.iter().enumerate() {
        let kinds = kinds(message);
        assert!(message.starts_with(&[0, 0, 0, 1]), "Annex B");
        assert_eq!(is_keyframe(message), number % 8 == 0, "{number}");
        if number % 8 == 0 {
            assert_eq!(kinds, [NalKind::Sequence, NalKind::Picture, NalKind::IdrSlice], "{number}");
        } else {
            assert_eq!(kinds, [NalKind::Slice], "{number}");
        }
    }
}

#[test]
fn after_a_gap_it_waits_for_a_keyframe() {
    let mut decoder = StreamDecoder::new(DecodeLimits::default());
    let messages = stream(20);
    let mut shown = Vec::new();
    for (number, message) in messages.iter().enumerate() {
        if number == 3 {
            decoder.interrupt();
            continue;
        }
        if let Decoded::Picture(frame) = decoder.decode(message, Vec::new()).unwrap() {
            shown.push((number, square_left(&frame)));
        }
    }
    let numbers: Vec<usize> = shown.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [0, 1, 2, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19]);
    for (number, left) in shown {
        assert!(left.abs_diff(square_left(&moving(160, 96, number as u32))) <= 1, "picture {number}");
    }
}

#[test]
fn a_stream_that_is_met_halfway_begins_at_its_next_keyframe() {
    let mut decoder = StreamDecoder::new(DecodeLimits::default());
    let kept: Vec<bool> = stream(12)[5..]
        .iter()
        .map(|message| decoder.decode(message, Vec::new()).unwrap() != Decoded::AwaitingKeyframe)
        .collect();
    assert_eq!(kept, [false, false, false, true, true, true, true]);
}

#[test]
fn the_size_may_change_with_a_keyframe() {
    let mut encoder = StreamEncoder::new(OPTIONS).unwrap();
    let mut decoder = StreamDecoder::new(DecodeLimits::default());
    for (width, height) in [(160, 96), (160, 96), (320, 240), (320, 240), (96, 64)] {
        let message = encoder.encode(&moving(width, height, 1)).unwrap().bytes;
        let Decoded::Picture(frame) = decoder.decode(&message, Vec::new()).unwrap() else { panic!() };
        assert_eq!((frame.width(), frame.height()), (width, height));
    }
}

#[test]
fn odd_sizes_lose_their_last_column_and_tiny_ones_are_refused() {
    let mut encoder = StreamEncoder::new(OPTIONS).unwrap();
    let message = encoder.encode(&moving(161, 97, 0)).unwrap().bytes;
    let Decoded::Picture(frame) =
        StreamDecoder::new(DecodeLimits::default()).decode(&message, Vec::new()).unwrap()
    else {
        panic!()
    };
    assert_eq!((frame.width(), frame.height()), (160, 96));
    let tiny = Frame::from_rgb(8, 8, vec![0; 192]).unwrap();
    assert!(matches!(encoder.encode(&tiny), Err(VideoError::NotEncodable { .. })));
}

#[test]
fn a_stream_larger_than_the_limit_is_refused() {
    let limits = DecodeLimits { max_side_px: 100, max_pixels: 10_000 };
    let error = StreamDecoder::new(limits).decode(&stream(1)[0], Vec::new()).unwrap_err();
    assert!(matches!(error, VideoError::TooLarge { width: 160, height: 96, .. }), "{error}");
}
