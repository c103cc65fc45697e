//! Messages as outcomes: what a recording or another vehicle says was seen.

use vision::outcome::{Adaptation, NearestMatch, Statistic};
use vision::{
    Gate, LandmarkOutcome, Miss, Outcome, PointPx, Prediction, Segment, SetVersion, Sighting, SizePx,
    Timestamp,
};

use super::check::{InvalidField, digest, finite, fraction, not_negative, point, present, within};
use super::stats::{channels, observed_stats};
use crate::keys::Id;
use crate::v1;

/// The camera and what it saw.
///
/// # Errors
/// The first field that is not allowed.
pub fn registration_from_wire(wire: &v1::Registration) -> Result<(Id, Outcome), InvalidField> {
    let camera = Id::new("camera", &wire.camera)?;
    let result = |(at, wire)| {
        landmark_outcome(wire).map_err(|invalid| invalid.inside(format_args!("landmarks[{at}]")))
    };
    let outcome = Outcome {
        sequence: wire.sequence,
        captured_at: Timestamp::from_nanos(wire.captured_at_ns),
        frame_size: SizePx { width: wire.frame_width_px, height: wire.frame_height_px },
        set_version: SetVersion { epoch: wire.set_epoch, version: wire.set_version },
        landmarks: wire.landmarks.iter().enumerate().map(result).collect::<Result<_, _>>()?,
    };
    Ok((camera, outcome))
}

fn landmark_outcome(wire: &v1::LandmarkResult) -> Result<LandmarkOutcome, InvalidField> {
    use v1::landmark_result::Result as WireResult;
    Ok(LandmarkOutcome {
        landmark: Id::new("landmark", &wire.landmark)?.as_str().to_owned(),
        digest: digest("digest", &wire.digest)?,
        instance: wire.instance,
        prediction: wire.prediction.as_ref().map(prediction).transpose()?,
        gate: wire.gate.as_ref().map(gate).transpose()?,
        result: match present("result", wire.result.as_ref())? {
            WireResult::Sighting(sighted) => Ok(sighting(sighted)?),
            WireResult::Miss(missed) => Err(miss(missed)?),
        },
        innovation_px: wire
            .innovation_px
            .map(|innovation_px| not_negative("innovation_px", innovation_px))
            .transpose()?,
        adaptation: wire.adaptation.as_ref().map(adaptation).transpose()?,
    })
}

fn sighting(wire: &v1::Sighting) -> Result<Sighting, InvalidField> {
    Ok(Sighting {
        centroid: point("sighting.centroid", wire.centroid.as_ref())?,
        area_px2: not_negative("sighting.area_px2", wire.area_px2)?,
        mask_area_2x: not_negative("sighting.mask_area_2x", wire.mask_area_2x)?,
        outline: outline(&wire.outline)?,
        segments: wire.segments.iter().enumerate().map(segment).collect::<Result<_, _>>()?,
        shape_score: wire.shape_score.map(|score| fraction("sighting.shape_score", score)).transpose()?,
        observed: observed_stats("sighting.observed", wire.observed.as_ref())?,
        score: fraction("sighting.score", wire.score)?,
        distinctness: fraction("sighting.distinctness", wire.distinctness)?,
    })
}

fn outline(wire: &[v1::Point]) -> Result<Vec<PointPx>, InvalidField> {
    let vertex = |(at, vertex)| point(format_args!("sighting.outline[{at}]"), Some(vertex));
    wire.iter().enumerate().map(vertex).collect()
}

fn segment((at, wire): (usize, &v1::Segment)) -> Result<Segment, InvalidField> {
    let coordinate = |name: &str, value| finite(format_args!("sighting.segments[{at}].{name}"), value);
    Ok(Segment {
        from: PointPx { x: coordinate("x1_px", wire.x1_px)?, y: coordinate("y1_px", wire.y1_px)? },
        to: PointPx { x: coordinate("x2_px", wire.x2_px)?, y: coordinate("y2_px", wire.y2_px)? },
    })
}

fn miss(wire: &v1::Miss) -> Result<Miss, InvalidField> {
    use v1::miss::Reason;
    Ok(match Reason::try_from(wire.reason) {
        Ok(Reason::OutsideFrame) => Miss::OutsideFrame,
        Ok(Reason::NoColour) => Miss::NoColour { best: wire.best.as_ref().map(nearest).transpose()? },
        Ok(Reason::TooSmall) => Miss::TooSmall,
        Ok(Reason::WrongShape) => {
            let score = present("miss.shape_score", wire.shape_score)?;
            Miss::WrongShape { score: fraction("miss.shape_score", score)? }
        }
        Ok(Reason::OutsideGate) => {
            let innovation_px = present("miss.innovation_px", wire.innovation_px)?;
            Miss::OutsideGate { innovation_px: not_negative("miss.innovation_px", innovation_px)? }
        }
        Ok(Reason::Occluded) => {
            let visible = present("miss.visible", wire.visible)?;
            Miss::Occluded { visible: fraction("miss.visible", visible)? }
        }
        Ok(Reason::Skipped) => Miss::Skipped,
        Ok(Reason::Unspecified) | Err(_) => {
            let allowed = "a Miss.Reason of waymark.v1 other than UNSPECIFIED";
            return Err(InvalidField::new("miss.reason", wire.reason, allowed));
        }
    })
}

fn nearest(wire: &v1::NearestMatch) -> Result<NearestMatch, InvalidField> {
    Ok(NearestMatch {
        at: point("miss.best.at", wire.at.as_ref())?,
        observed: observed_stats("miss.best.observed", wire.observed.as_ref())?,
        worst: statistic(wire.worst)?,
        excess: not_negative("miss.best.excess", wire.excess)?,
    })
}

fn statistic(number: i32) -> Result<Statistic, InvalidField> {
    use v1::nearest_match::Statistic as Wire;
    Ok(match Wire::try_from(number) {
        Ok(Wire::MeanRed) => Statistic::Mean(0),
        Ok(Wire::MeanGreen) => Statistic::Mean(1),
        Ok(Wire::MeanBlue) => Statistic::Mean(2),
        Ok(Wire::VarianceRed) => Statistic::Variance(0),
        Ok(Wire::VarianceGreen) => Statistic::Variance(1),
        Ok(Wire::VarianceBlue) => Statistic::Variance(2),
        Ok(Wire::Unspecified) | Err(_) => {
            let allowed = "a NearestMatch.Statistic of waymark.v1 other than UNSPECIFIED";
            return Err(InvalidField::new("miss.best.worst", number, allowed));
        }
    })
}

fn prediction(wire: &v1::Prediction) -> Result<Prediction, InvalidField> {
    Ok(Prediction {
        centroid: point("prediction.centroid", wire.centroid.as_ref())?,
        area_px2: not_negative("prediction.area_px2", wire.area_px2)?,
        covariance_px2: [
            not_negative("prediction.covariance_xx_px2", wire.covariance_xx_px2)?,
            finite("prediction.covariance_xy_px2", wire.covariance_xy_px2)?,
            not_negative("prediction.covariance_yy_px2", wire.covariance_yy_px2)?,
        ],
    })
}

fn gate(wire: &v1::Gate) -> Result<Gate, InvalidField> {
    Ok(Gate {
        centre: point("gate.centre", wire.centre.as_ref())?,
        radius_x_px: not_negative("gate.radius_x_px", wire.radius_x_px)?,
        radius_y_px: not_negative("gate.radius_y_px", wire.radius_y_px)?,
    })
}

fn adaptation(wire: &v1::Adaptation) -> Result<Adaptation, InvalidField> {
    let window_px = u16::try_from(wire.window_px)
        .map_err(|_| InvalidField::new("adaptation.window_px", wire.window_px, "at most 65535"))?;
    Ok(Adaptation {
        gain: not_negative("adaptation.gain", wire.gain)?,
        haze: within("adaptation.haze", wire.haze, -255.0..=255.0)?,
        noise_variance: channels("adaptation.noise_variance", &wire.noise_variance, not_negative)?,
        window_px,
        tolerance_scale: not_negative("adaptation.tolerance_scale", wire.tolerance_scale)?,
        full_frame: wire.full_frame,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::arbitrary::outcomes;
    use crate::convert::registration_to_wire;
    use crate::payload::WireMessage;
    use prost::Message as _;

    proptest! {
        #[test]
        fn every_outcome_survives_the_wire(outcome in outcomes()) {
            let payload = registration_to_wire("front", &outcome, &[]).encode_to_vec();
            let wire = v1::Registration::from_payload(&payload).unwrap();
            let (camera, received) = registration_from_wire(&wire).unwrap();
            prop_assert_eq!(camera.as_str(), "front");
            prop_assert_eq!(received, outcome);
        }

        #[test]
        fn no_payload_makes_the_reader_panic(payload in prop::collection::vec(any::<u8>(), 0..256)) {
            if let Ok(wire) = v1::Registration::from_payload(&payload) {
                let _ = registration_from_wire(&wire);
            }
        }
    }

    fn refusal(result: v1::LandmarkResult) -> InvalidField {
        let result = v1::LandmarkResult { landmark: "red".into(), digest: vec![0; 32], ..result };
        let wire = v1::Registration { camera: "front".into(), landmarks: vec![result], ..Default::default() };
        registration_from_wire(&wire).unwrap_err()
    }

    #[test]
    fn a_result_is_needed_and_must_be_known() {
        use v1::landmark_result::Result as WireResult;
        assert_eq!(refusal(v1::LandmarkResult::default()).field, "landmarks[0].result");
        let unknown = v1::Miss { reason: 99, ..Default::default() };
        let refused =
            refusal(v1::LandmarkResult { result: Some(WireResult::Miss(unknown)), ..Default::default() });
        assert_eq!((refused.field.as_str(), refused.value.as_str()), ("landmarks[0].miss.reason", "99"));
        let bare = v1::Sighting::default();
        let refused =
            refusal(v1::LandmarkResult { result: Some(WireResult::Sighting(bare)), ..Default::default() });
        assert_eq!(refused.to_string(), "landmarks[0].sighting.centroid is absent; allowed: present");
    }

    #[test]
    fn figures_that_are_no_numbers_are_refused() {
        let gate = v1::Gate {
            centre: Some(v1::Point { x_px: 1.0, y_px: f32::NAN }),
            radius_x_px: 1.0,
            radius_y_px: 1.0,
        };
        let refused = refusal(v1::LandmarkResult { gate: Some(gate), ..Default::default() });
        assert_eq!(refused.field, "landmarks[0].gate.centre.y_px");
    }
}
