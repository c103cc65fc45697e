//! Runs one of the benchmarked subjects once, in a function of its own, so that callgrind can count its instructions.
//!
//! `instructions` lists the subjects, `instructions SUBJECT` runs one. See `tests/instructions`.
#![allow(dead_code, reason = "the scenes are shared with the benches")]
#![allow(clippy::print_stdout, reason = "a tool for developers")]

#[path = "../benches/scene/mod.rs"]
mod scene;

use std::hint::black_box;
use std::sync::Arc;

use vision::mask::{Lanes, Masker};
use vision::{
    Follow, FollowOptions, Frame, FrameStamp, Landmark, LandmarkSet, NoProbe, RectPx, Request, SetVersion,
    Timestamp, Workspace, register_all,
};

const SIZE: vision::SizePx = scene::SIZES[0];

struct Subject {
    frame: Frame,
    landmarks: Vec<Landmark>,
    region: Option<RectPx>,
}

/// What is counted of registration: what frames may hold, the gate, and many landmarks.
const SUBJECTS: [&str; 7] = ["match", "nothing", "loose", "background", "everything", "gated", "landmarks"];

/// What is counted of following in `adaptive` mode: a block in its gate, and one that is searched for in the whole frame.
const FOLLOWED: [(&str, u32); 4] = [
    ("adaptive-gated-24", 24),
    ("adaptive-gated-60", 60),
    ("adaptive-search-24", 24),
    ("adaptive-search-60", 60),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Valgrind has no AVX-512, and the compiler's baseline makes the same loops of the same source.
    let lanes = Lanes::available().find(|lanes| lanes.name() == "avx2").unwrap_or_default();
    match std::env::args().nth(1) {
        None => {
            let names = SUBJECTS.into_iter().chain(FOLLOWED.map(|(name, _)| name));
            names.for_each(|name| println!("{name}-{}", lanes.name()));
        }
        Some(wanted) => {
            let followed =
                FOLLOWED.into_iter().find(|(name, _)| wanted == format!("{name}-{}", lanes.name()));
            if let Some((name, side_px)) = followed {
                follow(side_px, name.contains("search"));
                return Ok(());
            }
            let name = SUBJECTS.into_iter().find(|name| wanted == format!("{name}-{}", lanes.name()));
            run(&subject(name.ok_or("no such subject; without an argument they are listed")?), lanes);
        }
    }
    Ok(())
}

fn subject(name: &str) -> Subject {
    let region = None;
    match name {
        "gated" => {
            let (frame, region) = scene::one_block(SIZE, 24);
            Subject { frame, landmarks: vec![scene::red(12)], region: Some(region) }
        }
        "landmarks" => Subject { frame: scene::rink(SIZE), landmarks: scene::distinct(64), region },
        content => {
            let contents = scene::contents(SIZE, 12);
            let (_, frame, landmark) =
                contents.into_iter().find(|(name, ..)| *name == content).expect("a content of the scenes");
            Subject { frame, landmarks: vec![landmark], region }
        }
    }
}

fn run(subject: &Subject, lanes: Lanes) {
    let mut workspace = Workspace::with_masker(Masker::with_lanes(lanes));
    (0..2).for_each(|_| once(subject, &mut workspace));
    measured(subject, &mut workspace);
}

/// Follows a block where it stands; when it is `searched` for, nothing is known of it in any frame.
fn follow(side_px: u32, searched: bool) {
    let frame = scene::rink_of_blocks(SIZE, side_px);
    let set = LandmarkSet { version: SetVersion::default(), landmarks: vec![Arc::new(scene::red(12))] };
    let mut follow = Follow::new(FollowOptions { max_instances: 1, ..FollowOptions::default() }, set.clone());
    for sequence in 0..12 {
        if searched {
            follow.set_landmarks(LandmarkSet::default());
            follow.set_landmarks(set.clone());
        }
        let captured_at = Timestamp::from_nanos(sequence as i64 * 33_333_333);
        let stamp = FrameStamp { sequence, captured_at };
        if sequence < 11 {
            followed(&mut follow, &frame, stamp)
        } else {
            measured_following(&mut follow, &frame, stamp)
        }
    }
}

fn followed(follow: &mut Follow, frame: &Frame, stamp: FrameStamp) {
    let outcome = follow.on_frame(frame, stamp, &mut NoProbe);
    assert!(outcome.landmarks[0].result.is_ok(), "the block is found");
    follow.recycle(outcome);
}

/// What is counted: memory has grown before.
#[inline(never)]
fn measured_following(follow: &mut Follow, frame: &Frame, stamp: FrameStamp) {
    followed(black_box(follow), frame, stamp);
}

/// What is counted: memory has grown before.
#[inline(never)]
fn measured(subject: &Subject, workspace: &mut Workspace) {
    once(black_box(subject), workspace);
}

fn once(subject: &Subject, workspace: &mut Workspace) {
    let request = Request { region: subject.region, ..Request::default() };
    let landmarks = subject.landmarks.iter();
    register_all(&subject.frame, landmarks, &request, workspace, &mut NoProbe, |_, found, workspace| {
        found.into_iter().for_each(|sightings| workspace.recycle(sightings));
    });
}
