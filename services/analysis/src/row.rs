//! One row of `register`'s result: one frame, one landmark, one instance.

use serde::Serialize;
use vision::{LandmarkOutcome, Outcome, Place};

/// The columns, in this order; a field is empty (CSV) or null (NDJSON) when unknown, never 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row<'a> {
    /// The input as it was given.
    pub input: &'a str,
    /// Counts from 1 within its input and camera, undecodable pictures included; unknown where the picture of a
    /// recorded result is not in the recording.
    pub frame: Option<u64>,
    /// Capture time, ns since the Unix epoch; for plain pictures nominal: frame 1 at 0, then 30 a second.
    pub captured_at_ns: i64,
    /// The camera's id; unknown for plain pictures.
    pub camera: Option<&'a str>,
    /// The landmark's id.
    pub landmark: &'a str,
    /// Which of several objects that match one landmark.
    pub instance: u32,
    /// `measured`, or the name of the miss.
    pub result: &'static str,
    /// Centre of the object, frame pixels, corner origin.
    pub x_px: Option<f32>,
    /// Centre of the object, frame pixels, corner origin.
    pub y_px: Option<f32>,
    /// The object's own area, frame pixels².
    pub area_px2: Option<f32>,
    /// Area of the chosen component of the mask on the doubled grid.
    pub mask_area_2x: Option<f32>,
    /// Fit of the shape class, 0..1.
    pub shape_score: Option<f32>,
    /// How much the measurement deserves belief, 0..1.
    pub score: Option<f32>,
    /// The prior's centre, before this frame's measurement.
    pub predicted_x_px: Option<f32>,
    /// The prior's centre, before this frame's measurement.
    pub predicted_y_px: Option<f32>,
    /// The prior's area.
    pub predicted_area_px2: Option<f32>,
    /// Distance of measurement and prior.
    pub innovation_px: Option<f32>,
    /// Observed brightness over the descriptor's.
    pub gain: Option<f32>,
    /// Bearing, positive to the left of the optical axis.
    pub bearing_rad: Option<f32>,
    /// Range in the ground plane.
    pub range_m: Option<f32>,
}

/// Which frame an outcome belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameKey<'a> {
    /// The input as it was given.
    pub input: &'a str,
    /// Counts from 1 within its input and camera.
    pub frame: Option<u64>,
    /// The camera's id, where there is one.
    pub camera: Option<&'a str>,
}

/// The rows of one frame, in the outcome's order; `places` in the same order, fewer where they are not known.
pub fn rows<'a>(
    key: FrameKey<'a>,
    outcome: &'a Outcome,
    places: &'a [Place],
) -> impl Iterator<Item = Row<'a>> {
    let places = places.iter().copied().chain(std::iter::repeat(Place::default()));
    let entries = outcome.landmarks.iter().zip(places);
    entries.map(move |(landmark, place)| row(key, outcome.captured_at.nanos, landmark, place))
}

fn row<'a>(key: FrameKey<'a>, captured_at_ns: i64, outcome: &'a LandmarkOutcome, place: Place) -> Row<'a> {
    let sighting = outcome.result.as_ref().ok();
    let prediction = outcome.prediction.as_ref();
    Row {
        input: key.input,
        frame: key.frame,
        captured_at_ns,
        camera: key.camera,
        landmark: &outcome.landmark,
        instance: outcome.instance,
        result: outcome.result.as_ref().map_or_else(|miss| miss.name(), |_| "measured"),
        x_px: sighting.map(|seen| seen.centroid.x),
        y_px: sighting.map(|seen| seen.centroid.y),
        area_px2: sighting.map(|seen| seen.area_px2),
        mask_area_2x: sighting.map(|seen| seen.mask_area_2x),
        shape_score: sighting.and_then(|seen| seen.shape_score),
        score: sighting.map(|seen| seen.score),
        predicted_x_px: prediction.map(|prior| prior.centroid.x),
        predicted_y_px: prediction.map(|prior| prior.centroid.y),
        predicted_area_px2: prediction.map(|prior| prior.area_px2),
        innovation_px: outcome.innovation_px,
        gain: outcome.adaptation.map(|adaptation| adaptation.gain),
        bearing_rad: place.bearing_rad,
        range_m: place.range_m,
    }
}
