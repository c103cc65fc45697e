//! `cargo bench -p vision --bench adaptive`: what a frame costs in `adaptive` mode, all steps, beside the faithful
//! registration of the same frame in the same minutes.
//!
//! Times are the least of many, because other programs only ever add to them.
#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    clippy::disallowed_types,
    reason = "a stopwatch that prints"
)]
#![allow(dead_code, reason = "the scenes are shared with other benches")]

mod scene;

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use vision::{
    Follow, FollowOptions, Frame, FrameStamp, Landmark, LandmarkSet, NoProbe, Request, SetVersion, SizePx,
    Timestamp, Workspace, register,
};

const ROUNDS: u32 = 300;

fn least_us(mut work: impl FnMut()) -> f64 {
    let timed = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1e6
    };
    (0..ROUNDS).map(timed).fold(f64::INFINITY, f64::min)
}

fn follower(landmark: &Landmark, max_instances: u32) -> Follow {
    let set = LandmarkSet { version: SetVersion::default(), landmarks: vec![Arc::new(landmark.clone())] };
    Follow::new(FollowOptions { max_instances, ..FollowOptions::default() }, set)
}

fn stamp(sequence: u64) -> FrameStamp {
    FrameStamp { sequence, captured_at: Timestamp::from_nanos(sequence as i64 * 33_333_333) }
}

/// One object that is followed where it stands.
fn gated_us(frame: &Frame, landmark: &Landmark) -> f64 {
    let mut follow = follower(landmark, 1);
    let mut sequence = 0;
    for _ in 0..20 {
        follow.on_frame(frame, stamp(sequence), &mut NoProbe);
        sequence += 1;
    }
    least_us(|| {
        let outcome = follow.on_frame(black_box(frame), stamp(sequence), &mut NoProbe);
        assert!(outcome.landmarks[0].result.is_ok(), "the block is followed");
        sequence += 1;
    })
}

/// Nothing known: the whole frame is searched.
fn search_us(frame: &Frame, landmark: &Landmark) -> f64 {
    let set = follower(landmark, 32);
    let (options, set) = (*set.options(), set.landmarks().clone());
    // One follower keeps its memory; what it knows of the landmark is taken from it.
    let mut follow = Follow::new(options, set.clone());
    least_us(|| {
        follow.set_landmarks(LandmarkSet::default());
        follow.set_landmarks(set.clone());
        black_box(follow.on_frame(black_box(frame), stamp(0), &mut NoProbe));
    })
}

fn faithful_us(frame: &Frame, landmark: &Landmark) -> f64 {
    let mut workspace = Workspace::default();
    least_us(|| {
        let found = register(black_box(frame), landmark, &Request::default(), &mut workspace, &mut NoProbe);
        assert!(black_box(found).is_ok(), "the block is found");
    })
}

fn main() {
    println!("frame       block  gated us  search us  faithful whole frame us  search/faithful");
    for size in scene::SIZES {
        for side in [24, 60] {
            let (frame, landmark) = (scene::rink_of_blocks(size, side), scene::red(12));
            let (gated, search) = (gated_us(&frame, &landmark), search_us(&frame, &landmark));
            let faithful = faithful_us(&frame, &landmark);
            let SizePx { width, height } = size;
            println!(
                "{width:>4}x{height:<4} {side:>4}px {gated:>9.0} {search:>10.0} {faithful:>24.0} {:>16.1}",
                search / faithful
            );
        }
    }
}
