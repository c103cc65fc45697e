//! Registers scenes in `adaptive` mode from what is learned from their own boxes, and prints how well.
//!
//! usage: score_scenes SOURCE…
//!
//! SOURCE is a simulator source such as `sim:stop-sign?seed=7`, or a directory that `render_sequence` wrote. One line
//! is printed for each landmark of each source; a landmark that several objects show (`sign-1`, `sign-2`, …) is
//! counted object by object, those of less than 80 px² apart.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a tool for developers")]

mod scene;
mod tally;

use std::sync::Arc;

use scene::{Seen, Sequence};
use tally::Tally;
use vision::frame::decode::{DecodeLimits, decode};
use vision::{
    Follow, FollowOptions, Frame, FrameStamp, Landmark, LandmarkSet, LearnOptions, NoProbe, RectPx,
    SetVersion, ShapeClass, Timestamp, learn,
};

/// Sides of the two boxes that a road sign is learned from, px; other objects are learned where they are first whole.
const SIGN_BOXES_PX: [f64; 2] = [14.0, 40.0];

/// A landmark, and the objects of the scene that show it.
struct Subject {
    landmark: Landmark,
    objects: Vec<String>,
}

fn main() {
    println!("{}", tally::HEADER);
    for source in std::env::args().skip(1) {
        let sequence = Sequence::open(&source);
        for subject in subjects(&sequence) {
            println!("{}", tally::line(&source, &subject.landmark.id, &followed(&sequence, &subject)));
        }
    }
}

fn picture(sequence: &Sequence, at: usize) -> Frame {
    decode(&sequence.pictures[at], &DecodeLimits::default()).unwrap()
}

fn subjects(sequence: &Sequence) -> Vec<Subject> {
    let mut names: Vec<String> =
        sequence.truth.iter().flatten().map(|seen: &Seen| seen.object.clone()).collect();
    names.sort();
    names.dedup();
    let (signs, others): (Vec<String>, Vec<String>) =
        names.into_iter().partition(|name| name.starts_with("sign-"));
    let mut groups: Vec<Vec<String>> = others.into_iter().map(|name| vec![name]).collect();
    groups.extend((!signs.is_empty()).then_some(signs));
    groups.into_iter().filter_map(|objects| subject(sequence, objects)).collect()
}

fn subject(sequence: &Sequence, objects: Vec<String>) -> Option<Subject> {
    let several = objects.len() > 1;
    let shape = match objects[0].as_str() {
        _ if several => ShapeClass::Rectangle,
        "sign" => ShapeClass::Octagon,
        _ => ShapeClass::Block,
    };
    let boxes: Vec<(usize, RectPx)> = if shape.is_sign() {
        SIGN_BOXES_PX.iter().filter_map(|side| sequence.nearest_box(&objects, *side)).collect()
    } else {
        sequence.first_box(&objects).into_iter().collect()
    };
    let frames: Vec<(Frame, RectPx)> =
        boxes.into_iter().map(|(at, rect)| (picture(sequence, at), rect)).collect();
    let regions: Vec<(&Frame, RectPx)> = frames.iter().map(|(frame, rect)| (frame, *rect)).collect();
    let id = if several { "signs".to_owned() } else { objects[0].clone() };
    let landmark = learn(&regions, &LearnOptions { id, shape, ..LearnOptions::default() }).ok()?;
    Some(Subject { landmark, objects })
}

fn followed(sequence: &Sequence, subject: &Subject) -> Tally {
    let landmarks = vec![Arc::new(subject.landmark.clone())];
    let set = LandmarkSet { version: SetVersion::default(), landmarks };
    let mut follow = Follow::new(FollowOptions::default(), set);
    let mut tally = Tally::new(subject.objects.len());
    for at in 0..sequence.pictures.len() {
        let captured_at = Timestamp::from_nanos(at as i64 * 1_000_000_000 / 30);
        let stamp = FrameStamp { sequence: at as u64, captured_at };
        let outcome = follow.on_frame(&picture(sequence, at), stamp, &mut NoProbe);
        let truth: Vec<Option<&Seen>> = subject
            .objects
            .iter()
            .map(|name| sequence.truth[at].iter().find(|seen| seen.object == *name))
            .collect();
        tally.count(at, &truth, &outcome.landmarks);
    }
    tally
}
