//! The overlay against pictures that a person has looked at. `WAYMARK_REGENERATE=1` writes them anew.

#![allow(
    clippy::disallowed_methods,
    reason = "a golden test reads and writes pictures; the library does not"
)]

use std::path::PathBuf;

use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::encode_png;
use vision::overlay::{Layers, draw};
use vision::{
    Digest, Frame, Gate, LandmarkOutcome, Miss, Outcome, PointPx, Prediction, Segment, Sighting, SizePx,
};

/// Processors round anti-aliased edges differently by this much, levels.
const TOLERANCE: u8 = 4;

/// A background with dark, bright and busy parts.
fn background(size: SizePx) -> Frame {
    let rgb = (0..size.height)
        .flat_map(|y| {
            (0..size.width).flat_map(move |x| match (x * 3 / size.width, (x / 8 + y / 8) % 2) {
                (0, _) => [18, 18, 24],
                (1, _) => [214, 206, 190],
                (_, 0) => [58, 110, 200],
                _ => [150, 74, 62],
            })
        })
        .collect();
    Frame::from_rgb(size.width, size.height, rgb).expect("three bytes for each pixel")
}

fn square(centre: PointPx, side: f32) -> (Vec<PointPx>, Vec<Segment>) {
    let half = side / 2.0;
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
        .map(|(x, y)| PointPx::new(centre.x + x, centre.y + y));
    let segments = (0..3).map(|i| Segment { from: corners[i], to: corners[i + 1] }).collect();
    (corners.to_vec(), segments)
}

fn outcome(
    landmark: &str,
    instance: u32,
    expected: PointPx,
    result: Result<Sighting, Miss>,
) -> LandmarkOutcome {
    LandmarkOutcome {
        landmark: landmark.to_owned(),
        digest: Digest::default(),
        instance,
        prediction: Some(Prediction { centroid: expected, area_px2: 900.0, covariance_px2: [4.0, 0.0, 4.0] }),
        gate: Some(Gate { centre: expected, radius_x_px: 60.0, radius_y_px: 40.0 }),
        result,
        innovation_px: None,
        adaptation: None,
    }
}

fn scene(size: SizePx) -> Outcome {
    let at = |x: f32, y: f32| PointPx::new(x * size.width as f32, y * size.height as f32);
    let seen = |centroid: PointPx, side: f32| {
        let (outline, segments) = square(centroid, side);
        Ok(Sighting { centroid, area_px2: side * side, outline, segments, ..Sighting::default() })
    };
    let landmarks = vec![
        outcome("red", 0, at(0.15, 0.52), seen(at(0.16, 0.53), 40.0)),
        outcome("blue", 0, at(0.5, 0.3), Err(Miss::NoColour { best: None })),
        outcome("sign", 0, at(0.45, 0.7), seen(at(0.46, 0.71), 30.0)),
        outcome("sign", 1, at(0.78, 0.72), seen(at(0.79, 0.72), 60.0)),
        outcome("tan", 0, at(0.85, 0.25), Err(Miss::OutsideGate { innovation_px: 71.0 })),
        outcome("black", 0, at(1.4, 0.5), Err(Miss::OutsideFrame)),
    ];
    Outcome { frame_size: size, landmarks, ..Outcome::default() }
}

fn golden_path(size: SizePx) -> PathBuf {
    let file = format!("overlay-{}x{}.png", size.width, size.height);
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(file)
}

#[test]
fn the_overlay_looks_as_it_did_when_somebody_looked() {
    for (width, height) in [(640, 480), (1280, 720)] {
        let size = SizePx { width, height };
        let mut frame = background(size);
        draw(&mut frame, &scene(size), Layers::ALL);
        if std::env::var("WAYMARK_REGENERATE").is_ok_and(|value| value == "1") {
            std::fs::write(golden_path(size), encode_png(&frame).unwrap()).unwrap();
        }
        let golden = decode(&std::fs::read(golden_path(size)).unwrap(), &DecodeLimits::default()).unwrap();
        assert_eq!(golden.size(), frame.size());
        let differing =
            golden.rgb().iter().zip(frame.rgb()).filter(|(a, b)| a.abs_diff(**b) > TOLERANCE).count();
        assert_eq!(differing, 0, "{width}×{height}: look at it, then set WAYMARK_REGENERATE=1");
    }
}
