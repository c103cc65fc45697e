//! Bearing and range against the world's truth, over whole drives.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

use std::sync::Arc;

use simulator::{Rendered, SceneKind, SceneOptions, Simulator, TrueObject};
use vision::learn::{LearnOptions, learn};
use vision::{
    Digest, Follow, FollowOptions, FrameStamp, Landmark, LandmarkSet, NoProbe, Pinhole, Place, RectPx,
    ShapeClass, Timestamp, places,
};

/// A sighting further than this from every true object is of none of them, px.
const NEAR_PX: f64 = 8.0;
/// Objects of which less can be seen are ranged as if they were further away.
const WHOLE: f64 = 0.98;

/// Errors of one drive: bearing in rad, range as a part of the true range.
#[derive(Default)]
struct Errors {
    bearing_rad: Vec<f64>,
    range: Vec<f64>,
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn learned(view: &Rendered, object: &TrueObject, shape: ShapeClass, size_m: f32) -> Landmark {
    let [left, top, right, bottom] = object.bbox_px;
    let (x, y) = (left.floor() as u32, top.floor() as u32);
    let region = RectPx { x, y, width: right.floor() as u32 - x, height: bottom.floor() as u32 - y };
    let options = LearnOptions { id: "it".into(), shape, size_m: Some(size_m), ..LearnOptions::default() };
    Landmark { digest: Digest([7; 32]), ..learn(&[(&view.frame, region)], &options).unwrap() }
}

/// Follows the scene's objects whose names begin with `name`, and compares every place with the truth.
fn driven(scene: SceneKind, name: &str, shape: ShapeClass, size_m: f32) -> Errors {
    let mut simulator = Simulator::new(SceneOptions { seed: 3, ..SceneOptions::new(scene) }).unwrap();
    let intrinsics = simulator.calibration();
    let [centre_x_px, centre_y_px] = intrinsics.principal_px;
    let camera = Pinhole { size: intrinsics.size, focal_px: intrinsics.focal_px, centre_x_px, centre_y_px };
    let whole = |one: &TrueObject| one.object.starts_with(name) && one.visible > WHOLE;
    let views: Vec<Rendered> = (0..120).step_by(4).map(|index| simulator.render(index)).collect();
    let seen =
        views.iter().flat_map(|view| view.truth.iter().filter(|one| whole(one)).map(move |one| (view, one)));
    let (view, object) = seen.max_by(|a, b| a.1.area_px2.total_cmp(&b.1.area_px2)).unwrap();
    let landmarks = vec![Arc::new(learned(view, object, shape, size_m))];
    let set = LandmarkSet { landmarks, ..LandmarkSet::default() };
    let mut follow = Follow::new(FollowOptions::default(), set.clone());
    let mut errors = Errors::default();
    for (sequence, view) in views.iter().enumerate() {
        let captured_at = Timestamp::from_nanos(view.captured_offset_ns);
        let stamp = FrameStamp { sequence: sequence as u64, captured_at };
        let outcome = follow.on_frame(&view.frame, stamp, &mut NoProbe);
        for (entry, place) in outcome.landmarks.iter().zip(places(&outcome, &set, Some(&camera))) {
            let Ok(sighting) = &entry.result else { continue };
            let distance = |one: &TrueObject| {
                (one.centroid_px[0] - f64::from(sighting.centroid.x))
                    .hypot(one.centroid_px[1] - f64::from(sighting.centroid.y))
            };
            let Some(truth) = view.truth.iter().find(|one| whole(one) && distance(one) < NEAR_PX) else {
                continue;
            };
            errors.add(place, truth);
        }
    }
    errors
}

impl Errors {
    fn add(&mut self, place: Place, truth: &TrueObject) {
        self.bearing_rad.push((f64::from(place.bearing_rad.unwrap()) - truth.bearing_rad).abs());
        self.range.extend(place.range_m.map(|range_m| (f64::from(range_m) / truth.range_m - 1.0).abs()));
    }

    /// Medians, having found the object often enough.
    fn medians(mut self) -> (f64, f64) {
        assert!(
            self.range.len() >= 5,
            "only {} of {} sightings have a range",
            self.range.len(),
            self.bearing_rad.len()
        );
        (median(&mut self.bearing_rad), median(&mut self.range))
    }
}

#[test]
fn blocks_are_where_the_rink_has_them() {
    for colour in ["red", "blue"] {
        let (bearing_rad, range) = driven(SceneKind::Rink, colour, ShapeClass::Block, 0.1).medians();
        println!("{colour}: bearing {bearing_rad:.4} rad, range {:.1} %", range * 100.0);
        assert!(bearing_rad < 0.005 && range < 0.05, "{colour}: {bearing_rad} rad, {range}");
    }
}

/// Green signs are 2.7 to 3.2 m wide, and one width must do for all of them.
#[test]
fn signs_are_where_the_road_has_them() {
    for (scene, shape, size_m) in [
        (SceneKind::StopSign, ShapeClass::Octagon, 0.75),
        (SceneKind::GreenSigns, ShapeClass::Rectangle, 2.95),
    ] {
        let (bearing_rad, range) = driven(scene, "sign", shape, size_m).medians();
        println!("{scene}: bearing {bearing_rad:.4} rad, range {:.1} %", range * 100.0);
        assert!(bearing_rad < 0.005 && range < 0.12, "{scene}: {bearing_rad} rad, {range}");
    }
}
