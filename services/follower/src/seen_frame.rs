//! What one frame said, with all that is drawn of it: for pages that draw over the picture themselves.
//!
//! Live frames and recorded ones are told alike, so that one code draws both.

use schemars::JsonSchema;
use serde::Serialize;
use vision::outcome::{Gate, LandmarkOutcome};
use vision::{Outcome, Place, PointPx, Segment};
use waymark_proto::documents::VersionDocument;

use crate::status::{LandmarkStatus, landmark_from_outcome};

/// What one frame said, with all that is drawn of it.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct SeenFrame {
    /// The frame's number in its stream.
    pub sequence: u64,
    /// When it was captured, ns since the Unix epoch.
    pub captured_at_ns: i64,
    /// Which state of the landmark set was looked for.
    pub set: VersionDocument,
    /// Columns and rows of the frame that all coordinates belong to.
    pub frame_px: [u32; 2],
    /// One entry for each landmark and instance, in the order of the set.
    pub landmarks: Vec<SeenLandmark>,
}

/// What one frame said of one instance of one landmark.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct SeenLandmark {
    /// As in the status of a camera.
    #[serde(flatten)]
    pub status: LandmarkStatus,
    /// Digest of the descriptor that was looked for, hexadecimal.
    pub digest: String,
    /// Expected area before the measurement, frame pixels².
    pub predicted_area_px2: Option<f32>,
    /// Within which bounds it was believed.
    pub gate: Option<SeenGate>,
    /// The closed outline, first point not repeated: `[x, y]`, frame pixels.
    pub outline_px: Vec<[f32; 2]>,
    /// The straight pieces that the verdict on its shape rests on: `[x, y, x, y]`, frame pixels.
    pub segments_px: Vec<[f32; 4]>,
}

/// An ellipse, frame pixels.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub struct SeenGate {
    /// Centre.
    pub x_px: f32,
    /// Centre.
    pub y_px: f32,
    /// Half axis along x.
    pub radius_x_px: f32,
    /// Half axis along y.
    pub radius_y_px: f32,
}

impl SeenFrame {
    /// What `outcome` says; `places` in the same order, as far as they are known.
    #[must_use]
    pub fn new(outcome: &Outcome, places: &[Place]) -> Self {
        let places = places.iter().copied().chain(std::iter::repeat(Place::default()));
        Self {
            sequence: outcome.sequence,
            captured_at_ns: outcome.captured_at.nanos,
            set: VersionDocument { epoch: outcome.set_version.epoch, version: outcome.set_version.version },
            frame_px: [outcome.frame_size.width, outcome.frame_size.height],
            landmarks: outcome.landmarks.iter().zip(places).map(|(one, place)| seen(one, place)).collect(),
        }
    }
}

fn seen(one: &LandmarkOutcome, place: Place) -> SeenLandmark {
    let sighting = one.result.as_ref().ok();
    let point = |point: &PointPx| [point.x, point.y];
    SeenLandmark {
        status: landmark_from_outcome(one, place),
        digest: one.digest.to_string(),
        predicted_area_px2: one.prediction.map(|prediction| prediction.area_px2),
        gate: one.gate.map(SeenGate::from),
        outline_px: sighting.map_or_else(Vec::new, |seen| seen.outline.iter().map(point).collect()),
        segments_px: sighting.map_or_else(Vec::new, |seen| {
            let ends = |Segment { from, to }: &Segment| [from.x, from.y, to.x, to.y];
            seen.segments.iter().map(ends).collect()
        }),
    }
}

impl From<Gate> for SeenGate {
    fn from(gate: Gate) -> Self {
        let Gate { centre, radius_x_px, radius_y_px } = gate;
        Self { x_px: centre.x, y_px: centre.y, radius_x_px, radius_y_px }
    }
}

#[cfg(test)]
mod tests {
    use vision::SizePx;
    use vision::outcome::{Miss, Prediction, Sighting};

    use super::*;

    fn outcome_of(landmark: &str, result: Result<Sighting, Miss>) -> LandmarkOutcome {
        LandmarkOutcome {
            landmark: landmark.to_owned(),
            digest: vision::Digest::default(),
            instance: 0,
            prediction: Some(Prediction { area_px2: 40.0, ..Prediction::default() }),
            gate: Some(Gate { radius_x_px: 7.0, radius_y_px: 5.0, ..Gate::default() }),
            result,
            innovation_px: None,
            adaptation: None,
        }
    }

    #[test]
    fn status_and_geometry_stand_side_by_side() {
        let [from, to] = [PointPx::new(1.0, 2.0), PointPx::new(3.5, 4.0)];
        let sighting =
            Sighting { outline: vec![from, to], segments: vec![Segment { from, to }], ..Sighting::default() };
        let outcome = Outcome {
            sequence: 7,
            frame_size: SizePx { width: 64, height: 48 },
            landmarks: vec![outcome_of("red", Ok(sighting)), outcome_of("blue", Err(Miss::TooSmall))],
            ..Outcome::default()
        };
        let place = Place { bearing_rad: Some(0.25), range_m: Some(2.0) };
        let told = serde_json::to_value(SeenFrame::new(&outcome, &[place])).unwrap();
        assert_eq!((&told["sequence"], &told["frame_px"]), (&7.into(), &serde_json::json!([64, 48])));
        let [red, blue] = [&told["landmarks"][0], &told["landmarks"][1]];
        assert_eq!((red["id"].as_str(), red["result"].as_str()), (Some("red"), Some("measured")));
        assert_eq!(red["outline_px"], serde_json::json!([[1.0, 2.0], [3.5, 4.0]]));
        assert_eq!(red["segments_px"], serde_json::json!([[1.0, 2.0, 3.5, 4.0]]));
        assert_eq!((red["range_m"].as_f64(), red["gate"]["radius_y_px"].as_f64()), (Some(2.0), Some(5.0)));
        assert_eq!((blue["result"].as_str(), blue["range_m"].is_null()), (Some("too_small"), true));
        assert_eq!(
            (&blue["outline_px"], blue["predicted_area_px2"].as_f64()),
            (&serde_json::json!([]), Some(40.0))
        );
    }
}
