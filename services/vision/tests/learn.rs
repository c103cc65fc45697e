//! Learning a descriptor from synthetic pictures whose colours are known.

#![allow(clippy::unwrap_used, reason = "scenes are built outside the test functions")]

use vision::learn::{Preset, Template, Tolerance};
use vision::{ColorStats, Frame, LearnError, LearnOptions, RectPx, WindowPx, learn};

const FLOOR: [u8; 3] = [40, 90, 170];
const RED: [u8; 3] = [200, 40, 30];
const WHITE: [u8; 3] = [230, 230, 225];

/// A disc of radius 14 with a white bar across it, on a floor.
fn sign() -> Frame {
    let mut rgb = Vec::new();
    for y in 0..80_i32 {
        for x in 0..80_i32 {
            let (dx, dy) = (x - 40, y - 40);
            let color = match dx * dx + dy * dy {
                r2 if r2 > 196 => FLOOR,
                _ if dy.abs() <= 1 && dx.abs() <= 9 => WHITE,
                _ => RED,
            };
            rgb.extend(color);
        }
    }
    Frame::from_rgb(80, 80, rgb).unwrap()
}

const BOX: RectPx = RectPx { x: 26, y: 26, width: 29, height: 29 };

#[test]
fn corners_and_lettering_are_not_the_object() {
    let landmark = learn(&[(&sign(), BOX)], &LearnOptions::default()).unwrap();
    assert_eq!(landmark.shades, [ColorStats { mean: [200.0, 40.0, 30.0], variance: [0.0; 3] }]);
    assert_eq!(landmark.window_px, WindowPx::square(12));
    assert_eq!(landmark.tolerance, ColorStats::uniform(15.0, 50.0));
}

#[test]
fn a_second_picture_in_other_light_adds_a_shade_and_the_same_light_does_not() {
    let bright = sign();
    let dim = Frame::from_rgb(80, 80, bright.rgb().iter().map(|v| v / 10 * 7).collect()).unwrap();
    let shades = |second: &Frame| {
        learn(&[(&bright, BOX), (second, BOX)], &LearnOptions::default()).unwrap().shades.len()
    };
    assert_eq!(shades(&dim), 2);
    assert_eq!(shades(&bright), 1);
}

#[test]
fn exact_takes_every_pixel_and_the_regions_size() {
    let options = LearnOptions { template: Template::Exact, ..LearnOptions::default() };
    let landmark = learn(&[(&sign(), BOX)], &options).unwrap();
    assert_eq!(landmark.window_px, WindowPx::square(29));
    assert!(landmark.shades[0].variance[0] > 1000.0);
}

#[test]
fn options_override() {
    let options = LearnOptions {
        window_px: Some(WindowPx { width: 4, height: 6 }),
        tolerance: Tolerance::Preset(Preset::GreenSign),
        ..LearnOptions::default()
    };
    let landmark = learn(&[(&sign(), BOX)], &options).unwrap();
    assert_eq!(landmark.window_px, WindowPx { width: 4, height: 6 });
    assert_eq!(landmark.tolerance, ColorStats::uniform(40.0, 150.0));
}

#[test]
fn nonsense_is_refused_by_name() {
    let frame = sign();
    let default = LearnOptions::default();
    let outside = RectPx { x: 60, y: 60, width: 30, height: 10 };
    assert_eq!(learn(&[], &default), Err(LearnError::NoRegion));
    assert!(matches!(learn(&[(&frame, outside)], &default), Err(LearnError::OutsideFrame { .. })));
    let speck = RectPx { x: 1, y: 1, width: 1, height: 1 };
    assert_eq!(learn(&[(&frame, speck)], &default), Err(LearnError::TooSmall { region: speck }));
    let options = LearnOptions {
        tolerance: Tolerance::Given(ColorStats::uniform(f32::NAN, 50.0)),
        ..LearnOptions::default()
    };
    assert!(learn(&[(&frame, BOX)], &options).unwrap_err().to_string().starts_with("tolerance is NaN"));
    let options = LearnOptions { size_m: Some(-1.0), ..LearnOptions::default() };
    assert!(learn(&[(&frame, BOX)], &options).unwrap_err().to_string().starts_with("size_m is -1"));
}
