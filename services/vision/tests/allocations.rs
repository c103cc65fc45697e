//! Once memory is there, registration asks for none: counted by an allocator of this test binary's own.
#![allow(unsafe_code, reason = "an allocator that counts and hands on")]

mod scene;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use scene::signs::{self, Sign};
use scene::{Block, GREY, RED, picture, red_landmark, set_of, stamp};
use vision::{
    ColorStats, Digest, Follow, FollowOptions, FollowState, Frame, Landmark, LandmarkOutcome, Mode, NoProbe,
    Outcome, RectPx, Request, ShapeClass, WindowPx, Workspace, register, register_all,
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

/// Follows landmarks to and fro over the frames, copies the state after each, gives every outcome back, and counts what the
/// last turn asked for.
/// `check` is shown every outcome, the first of each turn as number 0.
fn allocations_of_following(
    mode: Mode,
    landmarks: Vec<Landmark>,
    frames: &[Frame],
    mut check: impl FnMut(usize, &Outcome),
) -> u64 {
    let mut follow = Follow::new(FollowOptions { mode, ..FollowOptions::default() }, set_of(landmarks));
    let (mut sequence, mut state) = (0, FollowState::default());
    let mut turn = || {
        for (number, frame) in frames.iter().chain(frames.iter().rev()).enumerate() {
            sequence += 1;
            let outcome = follow.on_frame(frame, stamp(sequence), &mut NoProbe);
            check(number, &outcome);
            state.clone_from(follow.state());
            follow.recycle(outcome);
        }
    };
    (0..6).for_each(|_| turn());
    allocations(turn)
}

fn seen(outcome: &Outcome) -> usize {
    outcome.landmarks.iter().filter(|row| row.result.is_ok()).count()
}

fn allocations_of_following_four_blocks(mode: Mode) -> u64 {
    let frames: Vec<Frame> = (0..6).map(|step| frame(2 * step)).collect();
    let name = |(at, landmark)| Landmark { id: format!("block-{at}"), ..landmark };
    let landmarks = landmarks().into_iter().enumerate().map(name).collect();
    allocations_of_following(mode, landmarks, &frames, |_, outcome| assert_eq!(seen(outcome), 4))
}

#[test]
fn following_faithfully_allocates_nothing_in_the_steady_state() {
    assert_eq!(allocations_of_following_four_blocks(Mode::Faithful), 0);
}

#[test]
fn following_adaptively_allocates_nothing_in_the_steady_state() {
    assert_eq!(allocations_of_following_four_blocks(Mode::Adaptive), 0);
}

#[test]
fn telling_a_block_from_its_shadow_allocates_nothing() {
    // A little redder than the floor's shadow, which is (22, 47, 82).
    let blue = [38, 48, 82];
    let shades = vec![ColorStats { mean: blue.map(f32::from), variance: [4.0; 3] }];
    let landmark = Landmark { shades, ..red_landmark() };
    let block = |k: u32| Block::square(20.3 + 2.1 * k as f32, 50.0 + 0.4 * k as f32, 24.0, blue);
    let frames: Vec<Frame> = (0..10).map(|k| picture(&[block(k)], 1.0, k)).collect();
    let counted = allocations_of_following(Mode::Adaptive, vec![landmark], &frames, |_, outcome| {
        assert_eq!(seen(outcome), 1);
    });
    assert_eq!(counted, 0);
}

/// Three blocks of one colour; the first leaves its place behind a cover and is found again where it stands then.
#[test]
fn losing_objects_and_finding_them_again_allocates_nothing() {
    let frames: Vec<Frame> = (0..12)
        .map(|k: u32| {
            let cover = Block { x: 20.0, y: 20.0, width: 60.0, height: 50.0, color: GREY };
            let at = |x: f32, y: f32| Block::square(x, y, 22.0, RED);
            let away = if k < 9 { 30.0 } else { 84.0 };
            let blocks = [at(away, 36.0), at(130.0 + k as f32, 30.0), at(60.0, 100.0), cover];
            picture(&blocks[..if (4..9).contains(&k) { 4 } else { 3 }], 1.0, k)
        })
        .collect();
    let (mut lost, mut searched) = (0, 0);
    let counted = allocations_of_following(Mode::Adaptive, vec![red_landmark()], &frames, |_, outcome| {
        lost += outcome.landmarks.iter().filter(|row| row.result.is_err()).count();
        let full_frame =
            |row: &&LandmarkOutcome| row.adaptation.is_some_and(|adaptation| adaptation.full_frame);
        searched += outcome.landmarks.iter().filter(full_frame).count();
        assert!(seen(outcome) >= 2);
    });
    assert!(lost > 6 && searched > 6, "lost {lost} times, found again {searched} times");
    assert_eq!(counted, 0);
}

/// A large one, of which the outline shows, and one so small that a disc is fitted to its tint.
#[test]
fn following_round_lettered_signs_allocates_nothing() {
    let sign = |x: f32, width_px: f32| Sign::new(ShapeClass::Octagon, (x, 60.0), width_px);
    let frames: Vec<Frame> = (0..8)
        .map(|k| signs::picture(&[sign(70.3 + 1.3 * k as f32, 48.0), sign(180.6 - 0.8 * k as f32, 16.0)]))
        .collect();
    let landmark = signs::landmark(ShapeClass::Octagon);
    assert!(landmark.shades.len() > 1, "the face as a whole is a shade of its own");
    let counted = allocations_of_following(Mode::Adaptive, vec![landmark], &frames, |_, outcome| {
        assert!(seen(outcome) >= 1);
    });
    assert_eq!(counted, 0);
}

/// One before the side of another.
#[test]
fn following_boards_allocates_nothing() {
    let sign = |x: f32, y: f32, width_px: f32| Sign::new(ShapeClass::Rectangle, (x, y), width_px);
    let frames: Vec<Frame> = (0..8)
        .map(|k| k as f32)
        .map(|k| signs::picture(&[sign(150.3 + k, 55.0, 60.0), sign(108.5 + k, 61.2, 28.0)]))
        .collect();
    let landmark = signs::landmark(ShapeClass::Rectangle);
    let counted = allocations_of_following(Mode::Adaptive, vec![landmark], &frames, |_, outcome| {
        assert_eq!(seen(outcome), 2);
    });
    assert_eq!(counted, 0);
}
