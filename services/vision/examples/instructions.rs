//! Runs one of the benchmarked subjects once, in a function of its own, so that callgrind can count its instructions.
//!
//! `instructions` lists the subjects, `instructions SUBJECT` runs one. See `tests/instructions`.
#![allow(dead_code, reason = "the scenes are shared with the benches")]
#![allow(clippy::print_stdout, reason = "a tool for developers")]

#[path = "../benches/scene/mod.rs"]
mod scene;

use std::hint::black_box;

use vision::mask::{Lanes, Masker};
use vision::{Frame, Landmark, NoProbe, RectPx, Request, Workspace, register_all};

const SIZE: vision::SizePx = scene::SIZES[0];

struct Subject {
    frame: Frame,
    landmarks: Vec<Landmark>,
    region: Option<RectPx>,
}

/// What is counted: what frames may hold, the gate, and many landmarks.
const SUBJECTS: [&str; 7] = ["match", "nothing", "loose", "background", "everything", "gated", "landmarks"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Valgrind has no AVX-512, and the compiler's baseline makes the same loops of the same source.
    let lanes = Lanes::available().find(|lanes| lanes.name() == "avx2").unwrap_or_default();
    match std::env::args().nth(1) {
        None => SUBJECTS.iter().for_each(|name| println!("{name}-{}", lanes.name())),
        Some(wanted) => {
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
