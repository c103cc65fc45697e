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

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let contents = scene::contents(SIZE, 12)
        .map(|(name, frame, landmark)| (name, Subject { frame, landmarks: vec![landmark], region: None }));
    let (frame, region) = scene::one_block(SIZE, 24);
    let gated = Subject { frame, landmarks: vec![scene::red(12)], region: Some(region) };
    let many = Subject { frame: scene::rink(SIZE), landmarks: scene::distinct(64), region: None };
    let subjects = contents.into_iter().chain([("gated", gated), ("landmarks", many)]);
    // Valgrind has no AVX-512.
    let lanes: Vec<_> = Lanes::available().filter(|lanes| lanes.name() != "avx512").collect();
    let wanted = std::env::args().nth(1);
    for (name, subject) in subjects {
        for &lanes in &lanes {
            let name = format!("{name}-{}", lanes.name());
            match &wanted {
                None => println!("{name}"),
                Some(wanted) if *wanted == name => run(&subject, lanes),
                Some(_) => {}
            }
        }
    }
    Ok(())
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
