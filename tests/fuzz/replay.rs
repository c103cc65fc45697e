//! The committed corpus of the fuzz targets, in a plain test.

#![allow(clippy::unwrap_used)] // a test ends where its preparation fails

#[path = "fuzz_targets/targets.rs"]
mod targets;

use std::path::Path;

/// Feeds every file of a target's corpus, whole and cut and with bytes changed.
fn replay(target: &str, feed: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut fed = 0;
    for path in files {
        let bytes = std::fs::read(&path).unwrap();
        feed(&bytes);
        for part in 1..8 {
            feed(&bytes[..bytes.len() * part / 8]);
            let mut changed = bytes.clone();
            if let Some(byte) = changed.get_mut(bytes.len() * part / 8) {
                *byte ^= 0x5A;
            }
            feed(&changed);
        }
        fed += 1;
    }
    assert!(fed > 0, "{} is empty", folder.display());
}

#[test]
fn pictures_never_panic() {
    replay("picture", targets::picture);
}

#[test]
fn landmark_files_never_panic() {
    replay("landmark_json", targets::landmark_json);
}

#[test]
fn landmarks_from_the_network_never_panic() {
    replay("landmark_protobuf", targets::landmark_protobuf);
}

#[test]
fn recordings_never_panic() {
    replay("recording", targets::recording);
}
