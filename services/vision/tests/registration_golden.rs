//! What faithful registration makes of a frame, against a picture that a person has looked at. `WAYMARK_REGENERATE=1`
//! writes it anew.

#![allow(
    clippy::disallowed_methods,
    reason = "a golden test reads and writes pictures; the library does not"
)]

use std::path::PathBuf;
use std::sync::Arc;

use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::encode_png;
use vision::overlay::{Layers, draw};
use vision::{
    ColorStats, Digest, Follow, FollowOptions, Frame, FrameStamp, Landmark, LandmarkSet, Mode, NoProbe,
    SetVersion, ShapeClass, WindowPx,
};

/// Processors round anti-aliased edges differently by this much, levels.
const TOLERANCE: u8 = 4;

const SIZE: (u32, u32) = (320, 240);

/// What stands on the floor.
struct Object {
    id: &'static str,
    colour: [u8; 3],
    shape: ShapeClass,
    centre: (f64, f64),
    /// Half a width, px; what that means depends on the shape.
    half: f64,
}

const fn object(
    id: &'static str,
    colour: [u8; 3],
    shape: ShapeClass,
    centre: (f64, f64),
    half: f64,
) -> Object {
    Object { id, colour, shape, centre, half }
}

const OBJECTS: [Object; 5] = [
    object("red", [202, 71, 33], ShapeClass::Block, (60.0, 60.0), 22.0),
    object("blue", [51, 60, 130], ShapeClass::Circle, (160.0, 64.0), 26.0),
    object("green", [40, 140, 60], ShapeClass::Triangle, (262.0, 70.0), 34.0),
    object("orange", [225, 130, 30], ShapeClass::Octagon, (84.0, 170.0), 30.0),
    object("yellow", [220, 205, 50], ShapeClass::Rectangle, (220.0, 170.0), 28.0),
];

/// Whether a place, told from an object's centre, is part of it.
fn inside(shape: ShapeClass, x: f64, y: f64, half: f64) -> bool {
    match shape {
        ShapeClass::Any | ShapeClass::Block => x.abs() <= half && y.abs() <= half,
        ShapeClass::Rectangle => x.abs() <= 1.6 * half && y.abs() <= 0.7 * half,
        ShapeClass::Octagon => x.abs().max(y.abs()).max((x.abs() + y.abs()) / 2_f64.sqrt()) <= half,
        ShapeClass::Triangle => y <= 0.6 * half && y >= 2.0 * x.abs() - 1.2 * half,
        ShapeClass::Circle => x.hypot(y) <= half,
    }
}

fn frame() -> Frame {
    let pixel = |x: u32, y: u32| {
        let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let under =
            |object: &&Object| inside(object.shape, px - object.centre.0, py - object.centre.1, object.half);
        let colour = OBJECTS.iter().find(under).map_or([150, 158, 165], |object| object.colour);
        let noise = ((x * 7 + y * 13) ^ (x * y)) % 4;
        colour.map(|level| level + noise as u8)
    };
    let rgb = (0..SIZE.1).flat_map(|y| (0..SIZE.0).flat_map(move |x| pixel(x, y))).collect();
    Frame::from_rgb(SIZE.0, SIZE.1, rgb).expect("three levels for each pixel")
}

fn landmarks() -> LandmarkSet {
    let landmark = |object: &Object| Landmark {
        id: object.id.to_owned(),
        revision: 1,
        window_px: WindowPx::square(12),
        shades: vec![ColorStats {
            mean: object.colour.map(|level| f32::from(level) + 1.5),
            variance: [2.0; 3],
        }],
        tolerance: ColorStats::uniform(15.0, 50.0),
        shape: object.shape,
        size_m: None,
        digest: Digest::default(),
    };
    let landmarks = OBJECTS.iter().map(|object| Arc::new(landmark(object))).collect();
    LandmarkSet { version: SetVersion::default(), landmarks }
}

#[test]
fn registration_looks_as_it_did_when_somebody_looked() {
    let mut frame = frame();
    let options = FollowOptions { mode: Mode::Faithful, ..FollowOptions::default() };
    let mut follow = Follow::new(options, landmarks());
    let outcome = follow.on_frame(&frame, FrameStamp::default(), &mut NoProbe);
    assert!(outcome.landmarks.iter().all(|landmark| landmark.result.is_ok()), "{outcome:?}");
    draw(&mut frame, &outcome, Layers::ALL);
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden/registration-320x240.png");
    if std::env::var("WAYMARK_REGENERATE").is_ok_and(|value| value == "1") {
        std::fs::write(&path, encode_png(&frame).unwrap()).unwrap();
    }
    let golden = decode(&std::fs::read(&path).unwrap(), &DecodeLimits::default()).unwrap();
    assert_eq!(golden.size(), frame.size());
    let differing = golden.rgb().iter().zip(frame.rgb()).filter(|(a, b)| a.abs_diff(**b) > TOLERANCE).count();
    assert_eq!(differing, 0, "look at it, then set WAYMARK_REGENERATE=1");
}
