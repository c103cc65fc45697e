//! Damaged video is refused, never a panic, and the next keyframe is decoded again.

use std::io::Cursor;
use std::sync::LazyLock;

use proptest::prelude::*;
use video::{Decoded, FilmReader, StreamDecoder};
use vision::frame::decode::DecodeLimits;

use crate::films::film;
use crate::pictures::stream;

static STREAM: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| stream(24));
static FILM: LazyLock<Vec<u8>> = LazyLock::new(|| film(12));

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn damaged_streams_recover_at_the_next_keyframe(
        message in 0..16_usize,
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..12),
        cut in proptest::option::of(any::<proptest::sample::Index>()),
    ) {
        let mut decoder = StreamDecoder::new(DecodeLimits::default());
        for (number, sent) in STREAM.iter().enumerate() {
            let mut sent = sent.clone();
            if number == message {
                for (at, value) in &changes {
                    *at.get_mut(&mut sent) = *value;
                }
                if let Some(cut) = cut {
                    sent.truncate(cut.index(sent.len()));
                }
            }
            let decoded = decoder.decode(&sent, Vec::new());
            if number < message || number >= message.next_multiple_of(8).max(message + 1) && number >= 16 {
                prop_assert!(matches!(decoded, Ok(Decoded::Picture(_))), "message {number}: {decoded:?}");
            }
        }
    }

    #[test]
    fn random_streams_never_panic(messages in proptest::collection::vec(
        (0..6_u8, proptest::collection::vec(any::<u8>(), 0..200)), 1..6,
    )) {
        let mut decoder = StreamDecoder::new(DecodeLimits::default());
        for (kind, mut bytes) in messages {
            let header = [0x67, 0x68, 0x65, 0x41, 0x01, 0x6f][usize::from(kind)];
            bytes.splice(0..0, [0, 0, 0, 1, header]);
            let _ = decoder.decode(&bytes, Vec::new());
        }
    }

    #[test]
    fn damaged_films_never_panic(
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..40),
        cut in proptest::option::of(any::<proptest::sample::Index>()),
    ) {
        let mut film = FILM.clone();
        for (at, value) in changes {
            *at.get_mut(&mut film) = value;
        }
        if let Some(cut) = cut {
            film.truncate(cut.index(film.len()));
        }
        if let Ok(reader) = FilmReader::open(Cursor::new(film), DecodeLimits::default()) {
            // A damaged index can name pictures without end.
            let _ = reader.take(200).filter(Result::is_ok).count();
        }
    }
}
