//! Films there and back.

use std::io::Cursor;
use std::time::Duration;

use video::{FilmReader, FilmWriter, VideoError};
use vision::frame::decode::DecodeLimits;

use crate::pictures::{moving, square_left};

pub(crate) fn film(frames: u32) -> Vec<u8> {
    let mut writer = FilmWriter::new(Cursor::new(Vec::new())).unwrap();
    for number in 0..frames {
        writer.push(&moving(160, 96, number), at(number)).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// A frame rate that is not even: 25 a second, then 50.
fn at(number: u32) -> Duration {
    Duration::from_millis(u64::from(if number < 10 { number * 40 } else { 400 + (number - 10) * 20 }))
}

#[test]
fn every_frame_that_goes_in_comes_out_with_its_time() {
    let film = film(40);
    let reader = FilmReader::open(Cursor::new(film), DecodeLimits::default()).unwrap();
    assert_eq!(reader.remaining(), 40);
    let frames: Vec<_> = reader.map(Result::unwrap).collect();
    assert_eq!(frames.len(), 40);
    for (number, frame) in (0..).zip(frames) {
        assert_eq!(frame.shown_after, at(number), "frame {number}");
        assert!(square_left(&frame.frame).abs_diff(square_left(&moving(160, 96, number))) <= 1);
    }
}

#[test]
fn a_film_has_one_size() {
    let mut writer = FilmWriter::new(Cursor::new(Vec::new())).unwrap();
    writer.push(&moving(160, 96, 0), Duration::ZERO).unwrap();
    let error = writer.push(&moving(96, 64, 0), Duration::from_millis(40)).unwrap_err();
    assert!(error.to_string().contains("160×96"), "{error}");
}

#[test]
fn what_is_no_film_says_so() {
    for bytes in [&b""[..], b"hello", &[0; 64], &film(2)[..200]] {
        let error = FilmReader::open(Cursor::new(bytes), DecodeLimits::default()).unwrap_err();
        assert!(matches!(error, VideoError::Film(_)), "{error}");
    }
}

#[test]
fn a_film_with_a_hole_gives_what_it_has_and_counts_the_rest() {
    let mut film = film(40);
    let place = |name: &[u8]| film.windows(4).position(|four| four == name).expect("such a box");
    let (pictures, index) = (place(b"mdat") + 4, place(b"moov"));
    let end = if index > pictures { index - 4 } else { film.len() };
    film[(pictures + end) / 2..end - 16].fill(0);
    let reader = FilmReader::open(Cursor::new(film), DecodeLimits::default()).unwrap();
    let results: Vec<bool> = reader.map(|frame| frame.is_ok()).collect();
    assert_eq!(results.len(), 40, "each frame comes out or is counted");
    assert!(results[0] && results.contains(&false));
}
