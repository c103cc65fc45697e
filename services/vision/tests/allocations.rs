//! Once memory is there, registration asks for none: counted by an allocator of this test binary's own.
#![allow(unsafe_code, reason = "an allocator that counts and hands on")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use std::sync::Arc;

use vision::{
    ColorStats, Digest, Follow, FollowOptions, Frame, FrameStamp, Landmark, LandmarkSet, Mode, NoProbe,
    RectPx, Request, ShapeClass, Timestamp, WindowPx, Workspace, register, register_all,
};

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every call is handed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above; the memory came from there.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn allocations(work: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.with(Cell::get);
    work();
    ALLOCATIONS.with(Cell::get) - before
}

const COLOURS: [[u8; 3]; 4] = [[202, 71, 33], [51, 60, 82], [40, 140, 60], [220, 200, 40]];

/// A floor with a block of each colour, everything moved by `step` pixels.
fn frame(step: u32) -> Frame {
    let pixel = |x: u32, y: u32| {
        let block = x.checked_sub(20 + step).map_or(9, |x| x / 70) as usize;
        let inside = x >= 20 + step && (x - 20 - step) % 70 < 40 && (60 + step..100 + step).contains(&y);
        let noise = (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) >> 7 & 3;
        let colour = if inside && block < COLOURS.len() { COLOURS[block] } else { [150, 158, 165] };
        colour.map(|level| level + noise as u8)
    };
    let rgb = (0..200).flat_map(|y| (0..320).flat_map(move |x| pixel(x, y))).collect();
    Frame::from_rgb(320, 200, rgb).expect("three levels for each pixel")
}

fn landmarks() -> Vec<Landmark> {
    let landmark = |colour: [u8; 3]| Landmark {
        id: "counted".into(),
        revision: 1,
        window_px: WindowPx::square(12),
        shades: vec![ColorStats { mean: colour.map(f32::from), variance: [2.0; 3] }],
        tolerance: ColorStats::uniform(15.0, 50.0),
        shape: ShapeClass::Block,
        size_m: None,
        digest: Digest::default(),
    };
    COLOURS.into_iter().map(landmark).collect()
}

#[test]
fn registration_allocates_nothing_in_the_steady_state() {
    let (frames, landmarks) = ((0..6).map(|step| frame(2 * step)).collect::<Vec<_>>(), landmarks());
    let mut workspace = Workspace::default();
    let gate = Request { region: Some(RectPx { x: 10, y: 50, width: 90, height: 90 }), ..Request::default() };
    let mut pass = |frame: &Frame| {
        let mut found = 0;
        for request in [Request::default(), gate] {
            let sightings = register(frame, &landmarks[0], &request, &mut workspace, &mut NoProbe).unwrap();
            found += sightings.len();
            workspace.recycle(sightings);
        }
        let every = landmarks.iter();
        register_all(
            frame,
            every,
            &Request::default(),
            &mut workspace,
            &mut NoProbe,
            |_, seen, workspace| {
                let sightings = seen.unwrap();
                found += sightings.len();
                workspace.recycle(sightings);
            },
        );
        found
    };
    // Which memory serves which sighting changes from pass to pass, so each grows to its size over a few.
    for _ in 0..4 {
        frames.iter().for_each(|frame| assert!(pass(frame) >= 6));
    }
    let counted = allocations(|| frames.iter().for_each(|frame| assert!(pass(frame) >= 6)));
    assert_eq!(counted, 0, "allocations in {} frames", frames.len());
}

/// Follows all landmarks to and fro over the frames, gives every outcome back, and counts what the last turn asked for.
fn allocations_of_following(mode: Mode) -> u64 {
    let frames: Vec<Frame> = (0..6).map(|step| frame(2 * step)).collect();
    let landmarks = landmarks()
        .into_iter()
        .enumerate()
        .map(|(at, landmark)| Arc::new(Landmark { id: format!("block-{at}"), ..landmark }));
    let set = LandmarkSet { landmarks: landmarks.collect(), ..LandmarkSet::default() };
    let mut follow = Follow::new(FollowOptions { mode, ..FollowOptions::default() }, set);
    let mut sequence = 0;
    let mut turn = || {
        for frame in frames.iter().chain(frames.iter().rev()) {
            sequence += 1;
            let captured_at = Timestamp { nanos: 33_333_333 * sequence as i64 };
            let outcome = follow.on_frame(frame, FrameStamp { sequence, captured_at }, &mut NoProbe);
            assert_eq!(outcome.landmarks.iter().filter(|landmark| landmark.result.is_ok()).count(), 4);
            follow.recycle(outcome);
        }
    };
    (0..4).for_each(|_| turn());
    allocations(turn)
}

#[test]
fn following_faithfully_allocates_nothing_in_the_steady_state() {
    assert_eq!(allocations_of_following(Mode::Faithful), 0);
}

/// Patches of the picture around every object are made anew for each frame; what they take must not grow unnoticed.
#[test]
fn following_adaptively_allocates_within_bounds() {
    let (frames, objects) = (12, 4);
    let counted = allocations_of_following(Mode::Adaptive);
    assert!(
        counted < 160 * frames * objects,
        "{counted} allocations for {objects} objects in {frames} frames"
    );
}
