//! What is fed with arbitrary bytes: everything that reads what came from outside. None of it may panic, and what is
//! accepted must come back the same way.
//!
//! `tests/fuzz/fuzz_targets` feeds them from cargo-fuzz, `replay.rs` with the committed corpus in every plain test run.

use prost::Message;
use recording::reader::{MessageReader, Strictness};
use vision::frame::decode::{DecodeLimits, decode};
use waymark_proto::convert::{landmark_from_wire, landmark_to_wire, set_from_wire};
use waymark_proto::json::{landmark_from_json, landmark_to_json, set_from_json};
use waymark_proto::v1;

/// JPEG or PNG.
pub(crate) fn picture(bytes: &[u8]) {
    let limits = DecodeLimits { max_side_px: 512, max_pixels: 1 << 16 };
    if let Ok(frame) = decode(bytes, &limits) {
        assert_eq!(frame.rgb().len(), 3 * frame.width() as usize * frame.height() as usize);
        assert!(u64::from(frame.width()) * u64::from(frame.height()) <= limits.max_pixels);
    }
}

/// A landmark file, and a file of a set.
pub(crate) fn landmark_json(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _any = set_from_json(text);
    if let Ok(landmark) = landmark_from_json(text) {
        let written = landmark_to_json(&landmark).expect("what was accepted can be written");
        let again = landmark_from_json(&written).expect("and read");
        assert_eq!(again.digest, landmark.digest);
    }
}

/// A landmark and a set as they come from the network.
pub(crate) fn landmark_protobuf(bytes: &[u8]) {
    if let Ok(wire) = v1::LandmarkSet::decode(bytes) {
        let _any = set_from_wire(&wire);
    }
    let Ok(wire) = v1::Landmark::decode(bytes) else { return };
    if let Ok((landmark, epoch)) = landmark_from_wire(&wire) {
        let again =
            landmark_from_wire(&landmark_to_wire(&landmark, epoch)).expect("what was accepted is accepted");
        assert_eq!(again, (landmark, epoch));
    }
}

/// A recording, whole, cut or damaged.
pub(crate) fn recording(bytes: &[u8]) {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    std::io::Write::write_all(&mut file, bytes).expect("it can be written");
    for strictness in [Strictness::Strict, Strictness::Lenient] {
        if let Ok(reader) = MessageReader::open(file.path(), strictness) {
            reader.take_while(Result::is_ok).for_each(drop);
        }
    }
}
