//! The state of a camera's [`vision::Follow`] ↔ its message.

use std::fmt;

use vision::follow::{FollowOptions, FollowState, FrameStamp, LandmarkState, Mode, Track};
use vision::predict::{Axis, Fix, Fixes, Kalman, PredictionMethod, Predictor};
use vision::register::ShapeVeto;
use vision::{PointPx, Timestamp};

use super::check::{
    InvalidField, count_within, digest, finite, finite_f64, fraction, not_negative, point, present, within,
};
use super::stats::channels;
use crate::keys::Id;
use crate::v1;

/// Fixes that a predictor remembers.
const MAX_FIXES: u64 = Fixes::MOST as u64;

/// What a message about a camera's state says.
#[derive(Clone, Debug, PartialEq)]
pub struct FollowSnapshot {
    /// The camera.
    pub camera: Id,
    /// How it follows.
    pub options: FollowOptions,
    /// Where it stands.
    pub state: FollowState,
}

/// The message that lets another process continue where `camera` stands.
#[must_use]
pub fn follow_state_to_wire(camera: &str, options: &FollowOptions, state: &FollowState) -> v1::FollowState {
    let FollowState { last, noise_variance, turn, landmarks } = state;
    v1::FollowState {
        camera: camera.to_owned(),
        options: Some(options_to_wire(options)),
        last: last.map(|FrameStamp { sequence, captured_at }| v1::FrameStamp {
            sequence,
            captured_at_ns: captured_at.nanos,
        }),
        noise_variance: noise_variance.to_vec(),
        turn: u32::try_from(*turn).unwrap_or(u32::MAX),
        landmarks: landmarks.iter().map(landmark_to_wire).collect(),
    }
}

fn options_to_wire(options: &FollowOptions) -> v1::FollowOptions {
    let FollowOptions { mode, prediction, shape_veto, max_instances, budget_px } = *options;
    v1::FollowOptions {
        mode: mode.name().to_owned(),
        prediction: prediction.name().to_owned(),
        require_shape: shape_veto == ShapeVeto::Required,
        max_instances,
        budget_px,
    }
}

fn landmark_to_wire(state: &LandmarkState) -> v1::LandmarkTracks {
    let LandmarkState { id, digest, next_instance, frames_since_search, tracks } = state;
    v1::LandmarkTracks {
        landmark: id.clone(),
        digest: digest.0.to_vec(),
        next_instance: *next_instance,
        frames_since_search: *frames_since_search,
        tracks: tracks.iter().map(track_to_wire).collect(),
    }
}

fn track_to_wire(track: &Track) -> v1::Track {
    let Track { instance, predictor, gain, haze, score, whole_area_px2, sightings, misses } = track;
    let Predictor { method, kalman, fixes } = predictor;
    v1::Track {
        instance: *instance,
        prediction: method.name().to_owned(),
        motion: Some(motion_to_wire(kalman)),
        fixes: fixes.iter().map(fix_to_wire).collect(),
        gain: *gain,
        haze: *haze,
        score: *score,
        whole_area_px2: *whole_area_px2,
        sightings: *sightings,
        misses: *misses,
    }
}

fn motion_to_wire(kalman: &Kalman) -> v1::Motion {
    let Kalman { fixed_at, x, y, log_area, unrest } = *kalman;
    v1::Motion {
        fixed_at_ns: fixed_at.nanos,
        x: Some(axis_to_wire(x)),
        y: Some(axis_to_wire(y)),
        log_area: Some(axis_to_wire(log_area)),
        unrest,
    }
}

fn axis_to_wire(Axis { value, rate, covariance }: Axis) -> v1::Axis {
    v1::Axis { value, rate, covariance: covariance.to_vec() }
}

fn fix_to_wire(fix: &Fix) -> v1::Fix {
    let Fix { captured_at, centroid: PointPx { x, y }, area_px2 } = *fix;
    v1::Fix { captured_at_ns: captured_at.nanos, centroid: Some(v1::Point { x_px: x, y_px: y }), area_px2 }
}

/// Where a camera stood when the message was written.
///
/// # Errors
/// The first field that is not allowed.
pub fn follow_state_from_wire(wire: &v1::FollowState) -> Result<FollowSnapshot, InvalidField> {
    let landmark =
        |(at, wire)| landmark(wire).map_err(|invalid| invalid.inside(format_args!("landmarks[{at}]")));
    Ok(FollowSnapshot {
        camera: Id::new("camera", &wire.camera)?,
        options: options(present("options", wire.options.as_ref())?)?,
        state: FollowState {
            last: wire.last.as_ref().map(|last| FrameStamp {
                sequence: last.sequence,
                captured_at: Timestamp::from_nanos(last.captured_at_ns),
            }),
            noise_variance: channels("noise_variance", &wire.noise_variance, not_negative)?,
            turn: wire.turn as usize,
            landmarks: wire.landmarks.iter().enumerate().map(landmark).collect::<Result<_, _>>()?,
        },
    })
}

fn options(wire: &v1::FollowOptions) -> Result<FollowOptions, InvalidField> {
    let modes = [Mode::Faithful, Mode::Adaptive];
    Ok(FollowOptions {
        mode: named("options.mode", &wire.mode, &modes, Mode::name)?,
        prediction: prediction("options.prediction", &wire.prediction)?,
        shape_veto: if wire.require_shape { ShapeVeto::Required } else { ShapeVeto::Off },
        max_instances: wire.max_instances,
        budget_px: wire.budget_px,
    })
}

fn prediction(field: &str, name: &str) -> Result<PredictionMethod, InvalidField> {
    named(field, name, &PredictionMethod::ALL, PredictionMethod::name)
}

fn named<T: Copy>(
    field: &str,
    name: &str,
    all: &[T],
    name_of: impl Fn(T) -> &'static str,
) -> Result<T, InvalidField> {
    all.iter().copied().find(|one| name_of(*one) == name).ok_or_else(|| {
        let allowed: Vec<_> = all.iter().copied().map(name_of).collect();
        InvalidField::new(field, format_args!("{name:?}"), allowed.join(", "))
    })
}

fn landmark(wire: &v1::LandmarkTracks) -> Result<LandmarkState, InvalidField> {
    let track = |(at, wire)| track(wire).map_err(|invalid| invalid.inside(format_args!("tracks[{at}]")));
    Ok(LandmarkState {
        id: Id::new("landmark", &wire.landmark)?.as_str().to_owned(),
        digest: digest("digest", &wire.digest)?,
        next_instance: wire.next_instance,
        frames_since_search: wire.frames_since_search,
        tracks: wire.tracks.iter().enumerate().map(track).collect::<Result<_, _>>()?,
    })
}

fn track(wire: &v1::Track) -> Result<Track, InvalidField> {
    count_within("fixes", wire.fixes.len() as u64, 0..=MAX_FIXES)?;
    Ok(Track {
        instance: wire.instance,
        predictor: Predictor {
            method: prediction("prediction", &wire.prediction)?,
            kalman: motion(present("motion", wire.motion.as_ref())?)?,
            fixes: wire.fixes.iter().enumerate().map(fix).collect::<Result<_, _>>()?,
        },
        gain: not_negative("gain", wire.gain)?,
        haze: within("haze", wire.haze, -255.0..=255.0)?,
        score: fraction("score", wire.score)?,
        whole_area_px2: not_negative("whole_area_px2", wire.whole_area_px2)?,
        sightings: wire.sightings,
        misses: wire.misses,
    })
}

fn fix((at, wire): (usize, &v1::Fix)) -> Result<Fix, InvalidField> {
    Ok(Fix {
        captured_at: Timestamp::from_nanos(wire.captured_at_ns),
        centroid: point(format_args!("fixes[{at}].centroid"), wire.centroid.as_ref())?,
        area_px2: finite(format_args!("fixes[{at}].area_px2"), wire.area_px2)?,
    })
}

fn motion(wire: &v1::Motion) -> Result<Kalman, InvalidField> {
    Ok(Kalman {
        fixed_at: Timestamp::from_nanos(wire.fixed_at_ns),
        x: axis("motion.x", wire.x.as_ref())?,
        y: axis("motion.y", wire.y.as_ref())?,
        log_area: axis("motion.log_area", wire.log_area.as_ref())?,
        unrest: finite_f64("motion.unrest", wire.unrest)?,
    })
}

fn axis(field: impl fmt::Display, wire: Option<&v1::Axis>) -> Result<Axis, InvalidField> {
    let wire = present(&field, wire)?;
    let &[value_value, value_rate, rate_rate] = wire.covariance.as_slice() else {
        let value = format_args!("{} values", wire.covariance.len());
        let allowed = "three values: value-value, value-rate, rate-rate";
        return Err(InvalidField::new(format_args!("{field}.covariance"), value, allowed));
    };
    let checked = |name: &str, value| finite_f64(format_args!("{field}.{name}"), value);
    Ok(Axis {
        value: checked("value", wire.value)?,
        rate: checked("rate", wire.rate)?,
        covariance: [
            checked("covariance[0]", value_value)?,
            checked("covariance[1]", value_rate)?,
            checked("covariance[2]", rate_rate)?,
        ],
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::arbitrary::{follow_options, follow_states};
    use crate::payload::WireMessage;
    use prost::Message as _;

    proptest! {
        #[test]
        fn every_state_survives_the_wire_to_the_last_bit(options in follow_options(), state in follow_states()) {
            let payload = follow_state_to_wire("front", &options, &state).encode_to_vec();
            let received = follow_state_from_wire(&v1::FollowState::from_payload(&payload).unwrap()).unwrap();
            prop_assert_eq!(received, FollowSnapshot { camera: Id::new("camera", "front").unwrap(), options, state });
        }

        #[test]
        fn no_payload_makes_the_reader_panic(payload in prop::collection::vec(any::<u8>(), 0..256)) {
            if let Ok(wire) = v1::FollowState::from_payload(&payload) {
                let _ = follow_state_from_wire(&wire);
            }
        }
    }

    #[test]
    fn what_is_not_allowed_is_named_from_the_state_down() {
        let whole = follow_state_to_wire("front", &FollowOptions::default(), &FollowState::default());
        let mode = v1::FollowState {
            options: Some(v1::FollowOptions { mode: "fast".into(), ..whole.options.clone().unwrap() }),
            ..whole.clone()
        };
        let refused = follow_state_from_wire(&mode).unwrap_err();
        assert_eq!(refused.to_string(), "options.mode is \"fast\"; allowed: faithful, adaptive");

        let track = v1::Track { prediction: "kalman".into(), ..Default::default() };
        let tracks = v1::LandmarkTracks {
            landmark: "red".into(),
            digest: vec![0; 32],
            tracks: vec![track],
            ..Default::default()
        };
        let refused =
            follow_state_from_wire(&v1::FollowState { landmarks: vec![tracks], ..whole }).unwrap_err();
        assert_eq!(refused.field, "landmarks[0].tracks[0].motion");
    }
}
