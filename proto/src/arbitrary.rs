//! Random domain values for property tests: everything that the domain allows.

use std::sync::Arc;

use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use vision::follow::{FollowOptions, FollowState, FrameStamp, LandmarkState, Mode, Track};
use vision::outcome::{Adaptation, NearestMatch, Statistic};
use vision::predict::{Axis, Fix, Fixes, Kalman, PredictionMethod, Predictor};
use vision::register::ShapeVeto;
use vision::{
    ColorStats, Digest, Gate, Landmark, LandmarkOutcome, LandmarkSet, Miss, Outcome, PointPx, Prediction,
    Segment, SetVersion, ShapeClass, Sighting, SizePx, Timestamp, WindowPx,
};

use crate::digest::landmark_digest;

fn stats() -> impl Strategy<Value = ColorStats> {
    (prop::array::uniform3(0.0f32..=255.0), prop::array::uniform3(0.0f32..=16_256.25))
        .prop_map(|(mean, variance)| ColorStats { mean, variance })
}

pub(crate) fn landmarks() -> impl Strategy<Value = Landmark> {
    (
        "[a-z0-9][a-z0-9_-]{0,62}",
        1..=u64::MAX,
        (1..=512u16, 1..=512u16),
        vec(stats(), 1..=16),
        stats(),
        prop::sample::select(ShapeClass::ALL.to_vec()),
        option::of(0.001f32..=1_000.0),
    )
        .prop_map(|(id, revision, (width, height), shades, tolerance, shape, size_m)| {
            let window_px = WindowPx { width, height };
            let digest = Digest::default();
            let mut landmark = Landmark { id, revision, window_px, shades, tolerance, shape, size_m, digest };
            landmark.digest = landmark_digest(&landmark);
            landmark
        })
}

pub(crate) fn sets() -> impl Strategy<Value = LandmarkSet> {
    let by_id = vec(landmarks(), 0..5).prop_map(|landmarks| {
        let mut landmarks: Vec<_> = landmarks.into_iter().map(Arc::new).collect();
        landmarks.sort_by(|one, other| one.id.cmp(&other.id));
        landmarks.dedup_by(|one, other| one.id == other.id);
        landmarks
    });
    (any::<u64>(), any::<u64>(), by_id).prop_map(|(epoch, version, landmarks)| LandmarkSet {
        version: SetVersion { epoch, version },
        landmarks,
    })
}

fn points() -> impl Strategy<Value = PointPx> {
    (-1e4f32..1e4, -1e4f32..1e4).prop_map(|(x, y)| PointPx { x, y })
}

fn sightings() -> impl Strategy<Value = Sighting> {
    let segments = (points(), points()).prop_map(|(from, to)| Segment { from, to });
    (
        (points(), 0.0f32..1e6, 0.0f32..1e6),
        vec(points(), 0..8),
        vec(segments, 0..4),
        option::of(0.0f32..=1.0),
        stats(),
        (0.0f32..=1.0, 0.0f32..=1.0),
    )
        .prop_map(
            |((centroid, area_px2, mask_area_2x), outline, segments, shape_score, observed, scores)| {
                let (score, distinctness) = scores;
                Sighting {
                    centroid,
                    area_px2,
                    mask_area_2x,
                    outline,
                    segments,
                    shape_score,
                    observed,
                    score,
                    distinctness,
                }
            },
        )
}

fn misses() -> impl Strategy<Value = Miss> {
    let statistic = prop_oneof![(0..3u8).prop_map(Statistic::Mean), (0..3u8).prop_map(Statistic::Variance)];
    let nearest = (points(), stats(), statistic, 0.0f32..100.0)
        .prop_map(|(at, observed, worst, excess)| NearestMatch { at, observed, worst, excess });
    prop_oneof![
        Just(Miss::OutsideFrame),
        Just(Miss::TooSmall),
        Just(Miss::Skipped),
        option::of(nearest).prop_map(|best| Miss::NoColour { best }),
        (0.0f32..=1.0).prop_map(|score| Miss::WrongShape { score }),
        (0.0f32..=1.0).prop_map(|visible| Miss::Occluded { visible }),
        (0.0f32..1e4).prop_map(|innovation_px| Miss::OutsideGate { innovation_px }),
    ]
}

fn predictions() -> impl Strategy<Value = Prediction> {
    (points(), 0.0f32..1e6, (0.0f32..1e4, -1e4f32..1e4, 0.0f32..1e4)).prop_map(
        |(centroid, area_px2, (xx, xy, yy))| Prediction { centroid, area_px2, covariance_px2: [xx, xy, yy] },
    )
}

fn adaptations() -> impl Strategy<Value = Adaptation> {
    let light = (0.0f32..4.0, -255.0f32..=255.0);
    (light, prop::array::uniform3(0.0f32..100.0), any::<u16>(), 0.0f32..4.0, any::<bool>()).prop_map(
        |((gain, haze), noise_variance, window_px, tolerance_scale, full_frame)| Adaptation {
            gain,
            haze,
            noise_variance,
            window_px,
            tolerance_scale,
            full_frame,
        },
    )
}

fn landmark_outcomes() -> impl Strategy<Value = LandmarkOutcome> {
    let gates = (points(), 0.0f32..1e4, 0.0f32..1e4).prop_map(|(centre, radius_x_px, radius_y_px)| Gate {
        centre,
        radius_x_px,
        radius_y_px,
    });
    let results = prop_oneof![sightings().prop_map(Ok), misses().prop_map(Err)];
    (
        "[a-z0-9][a-z0-9_-]{0,8}",
        any::<[u8; 32]>(),
        any::<u32>(),
        option::of(predictions()),
        option::of(gates),
        results,
        option::of(0.0f32..1e4),
        option::of(adaptations()),
    )
        .prop_map(|(landmark, digest, instance, prediction, gate, result, innovation_px, adaptation)| {
            let digest = Digest(digest);
            LandmarkOutcome {
                landmark,
                digest,
                instance,
                prediction,
                gate,
                result,
                innovation_px,
                adaptation,
            }
        })
}

pub(crate) fn outcomes() -> impl Strategy<Value = Outcome> {
    let versions = (any::<u64>(), any::<u64>()).prop_map(|(epoch, version)| SetVersion { epoch, version });
    let sizes = (any::<u32>(), any::<u32>()).prop_map(|(width, height)| SizePx { width, height });
    (any::<u64>(), any::<i64>(), sizes, versions, vec(landmark_outcomes(), 0..4)).prop_map(
        |(sequence, nanos, frame_size, set_version, landmarks)| Outcome {
            sequence,
            captured_at: Timestamp::from_nanos(nanos),
            frame_size,
            set_version,
            landmarks,
        },
    )
}

pub(crate) fn follow_options() -> impl Strategy<Value = FollowOptions> {
    let modes = prop::sample::select(vec![Mode::Faithful, Mode::Adaptive]);
    let predictions = prop::sample::select(PredictionMethod::ALL.to_vec());
    let vetoes = prop::sample::select(vec![ShapeVeto::Off, ShapeVeto::Required]);
    (modes, predictions, vetoes, any::<u32>(), any::<u64>()).prop_map(
        |(mode, prediction, shape_veto, max_instances, budget_px)| FollowOptions {
            mode,
            prediction,
            shape_veto,
            max_instances,
            budget_px,
        },
    )
}

fn axes() -> impl Strategy<Value = Axis> {
    (-1e7..1e7, -1e7..1e7, prop::array::uniform3(-1e8..1e8)).prop_map(|(value, rate, covariance)| Axis {
        value,
        rate,
        covariance,
    })
}

fn predictors() -> impl Strategy<Value = Predictor> {
    let fixes = (any::<i64>(), points(), 0.0f32..1e6).prop_map(|(nanos, centroid, area_px2)| Fix {
        captured_at: Timestamp::from_nanos(nanos),
        centroid,
        area_px2,
    });
    let kalman =
        (any::<i64>(), axes(), axes(), axes(), 1.0..400.0).prop_map(|(nanos, x, y, log_area, unrest)| {
            Kalman { fixed_at: Timestamp::from_nanos(nanos), x, y, log_area, unrest }
        });
    (prop::sample::select(PredictionMethod::ALL.to_vec()), kalman, vec(fixes, 0..=Fixes::MOST))
        .prop_map(|(method, kalman, fixes)| Predictor { method, kalman, fixes: fixes.into_iter().collect() })
}

fn tracks() -> impl Strategy<Value = Track> {
    let followed = (0.0f32..4.0, -255.0f32..=255.0, 0.0f32..=1.0, 0.0f32..1e6);
    (any::<u32>(), predictors(), followed, any::<u32>(), any::<u32>()).prop_map(
        |(instance, predictor, (gain, haze, score, whole_area_px2), sightings, misses)| Track {
            instance,
            predictor,
            gain,
            haze,
            score,
            whole_area_px2,
            sightings,
            misses,
        },
    )
}

fn landmark_states() -> impl Strategy<Value = LandmarkState> {
    ("[a-z0-9][a-z0-9_-]{0,8}", any::<[u8; 32]>(), any::<u32>(), any::<u32>(), vec(tracks(), 0..3)).prop_map(
        |(id, digest, next_instance, frames_since_search, tracks)| LandmarkState {
            id,
            digest: Digest(digest),
            next_instance,
            frames_since_search,
            tracks,
        },
    )
}

pub(crate) fn follow_states() -> impl Strategy<Value = FollowState> {
    let stamps = (any::<u64>(), any::<i64>())
        .prop_map(|(sequence, nanos)| FrameStamp { sequence, captured_at: Timestamp::from_nanos(nanos) });
    let turns = (0..1_000u32).prop_map(|turn| turn as usize);
    (option::of(stamps), prop::array::uniform3(0.0f32..100.0), turns, vec(landmark_states(), 0..4)).prop_map(
        |(last, noise_variance, turn, landmarks)| FollowState { last, noise_variance, turn, landmarks },
    )
}
