//! Outcomes as messages.

use vision::outcome::{Adaptation, NearestMatch, Statistic};
use vision::{Gate, LandmarkOutcome, Miss, Outcome, Place, PointPx, Prediction, Segment, Sighting};

use super::stats::stats_to_wire;
use crate::v1;

/// The message that tells others what `camera` saw in one frame, and where that is; `places` are those of the outcome's
/// entries, in their order, and may be fewer where they are not known.
#[must_use]
pub fn registration_to_wire(camera: &str, outcome: &Outcome, places: &[Place]) -> v1::Registration {
    let places = places.iter().copied().chain(std::iter::repeat(Place::default()));
    v1::Registration {
        camera: camera.to_owned(),
        sequence: outcome.sequence,
        captured_at_ns: outcome.captured_at.nanos,
        frame_width_px: outcome.frame_size.width,
        frame_height_px: outcome.frame_size.height,
        set_epoch: outcome.set_version.epoch,
        set_version: outcome.set_version.version,
        landmarks: outcome
            .landmarks
            .iter()
            .zip(places)
            .map(|(one, place)| landmark_result(one, place))
            .collect(),
    }
}

fn landmark_result(outcome: &LandmarkOutcome, place: Place) -> v1::LandmarkResult {
    use v1::landmark_result::Result as WireResult;
    v1::LandmarkResult {
        landmark: outcome.landmark.clone(),
        digest: outcome.digest.0.to_vec(),
        instance: outcome.instance,
        result: Some(match &outcome.result {
            Ok(sighting) => WireResult::Sighting(sighting_to_wire(sighting)),
            Err(miss) => WireResult::Miss(miss_to_wire(miss)),
        }),
        prediction: outcome.prediction.as_ref().map(prediction_to_wire),
        gate: outcome.gate.as_ref().map(gate_to_wire),
        innovation_px: outcome.innovation_px,
        adaptation: outcome.adaptation.as_ref().map(adaptation_to_wire),
        bearing_rad: place.bearing_rad,
        range_m: place.range_m,
    }
}

fn sighting_to_wire(sighting: &Sighting) -> v1::Sighting {
    v1::Sighting {
        centroid: Some(point_to_wire(sighting.centroid)),
        area_px2: sighting.area_px2,
        mask_area_2x: sighting.mask_area_2x,
        outline: sighting.outline.iter().copied().map(point_to_wire).collect(),
        segments: sighting.segments.iter().map(segment_to_wire).collect(),
        shape_score: sighting.shape_score,
        observed: Some(stats_to_wire(&sighting.observed)),
        score: sighting.score,
        distinctness: sighting.distinctness,
    }
}

fn miss_to_wire(miss: &Miss) -> v1::Miss {
    use v1::miss::Reason;
    let because = |reason: Reason| v1::Miss { reason: reason.into(), ..Default::default() };
    match miss {
        Miss::OutsideFrame => because(Reason::OutsideFrame),
        Miss::NoColour { best } => {
            v1::Miss { best: best.as_ref().map(nearest_to_wire), ..because(Reason::NoColour) }
        }
        Miss::TooSmall => because(Reason::TooSmall),
        Miss::WrongShape { score } => v1::Miss { shape_score: Some(*score), ..because(Reason::WrongShape) },
        Miss::OutsideGate { innovation_px } => {
            v1::Miss { innovation_px: Some(*innovation_px), ..because(Reason::OutsideGate) }
        }
        Miss::Occluded { visible } => v1::Miss { visible: Some(*visible), ..because(Reason::Occluded) },
        Miss::Skipped => because(Reason::Skipped),
    }
}

fn nearest_to_wire(nearest: &NearestMatch) -> v1::NearestMatch {
    v1::NearestMatch {
        at: Some(point_to_wire(nearest.at)),
        observed: Some(stats_to_wire(&nearest.observed)),
        worst: statistic_to_wire(nearest.worst).into(),
        excess: nearest.excess,
    }
}

fn statistic_to_wire(statistic: Statistic) -> v1::nearest_match::Statistic {
    use v1::nearest_match::Statistic as Wire;
    match statistic {
        Statistic::Mean(0) => Wire::MeanRed,
        Statistic::Mean(1) => Wire::MeanGreen,
        Statistic::Mean(2) => Wire::MeanBlue,
        Statistic::Variance(0) => Wire::VarianceRed,
        Statistic::Variance(1) => Wire::VarianceGreen,
        Statistic::Variance(2) => Wire::VarianceBlue,
        // There are three channels; the reader of the message would refuse this.
        Statistic::Mean(_) | Statistic::Variance(_) => Wire::Unspecified,
    }
}

fn prediction_to_wire(prediction: &Prediction) -> v1::Prediction {
    let [xx, xy, yy] = prediction.covariance_px2;
    v1::Prediction {
        centroid: Some(point_to_wire(prediction.centroid)),
        area_px2: prediction.area_px2,
        covariance_xx_px2: xx,
        covariance_xy_px2: xy,
        covariance_yy_px2: yy,
    }
}

fn gate_to_wire(gate: &Gate) -> v1::Gate {
    v1::Gate {
        centre: Some(point_to_wire(gate.centre)),
        radius_x_px: gate.radius_x_px,
        radius_y_px: gate.radius_y_px,
    }
}

fn adaptation_to_wire(adaptation: &Adaptation) -> v1::Adaptation {
    v1::Adaptation {
        gain: adaptation.gain,
        haze: adaptation.haze,
        noise_variance: adaptation.noise_variance.to_vec(),
        window_px: adaptation.window_px.into(),
        tolerance_scale: adaptation.tolerance_scale,
        full_frame: adaptation.full_frame,
    }
}

fn point_to_wire(point: PointPx) -> v1::Point {
    v1::Point { x_px: point.x, y_px: point.y }
}

fn segment_to_wire(segment: &Segment) -> v1::Segment {
    v1::Segment { x1_px: segment.from.x, y1_px: segment.from.y, x2_px: segment.to.x, y2_px: segment.to.y }
}
