//! One landmark over one camera's drive.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use vision::{LandmarkOutcome, Outcome};

use super::Spread;
use crate::drive::{CameraDrive, DriveFrame};
use crate::score::{Claim, Score, quantile, score};
use crate::truth::{Truth, meant_object};

/// How one landmark fared. Of several instances the best-scored one stands for the frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LandmarkFigures {
    /// The landmark's id.
    pub id: String,
    /// Frames in which it was looked for.
    pub frames: u64,
    /// Frames in which it was measured.
    pub measured: u64,
    /// Their part of all frames.
    pub measured_rate: Option<f64>,
    /// Frames in which it was not, by reason.
    pub misses: BTreeMap<String, u64>,
    /// Measured minus predicted centre, along x, px.
    pub prediction_error_x_px: Option<Spread>,
    /// Along y, px.
    pub prediction_error_y_px: Option<Spread>,
    /// Measured minus predicted area, px².
    pub prediction_error_area_px2: Option<Spread>,
    /// Mean distance of the measured centre from the predicted one.
    pub innovation_mean_px: Option<f64>,
    /// Median of that distance.
    pub innovation_median_px: Option<f64>,
    /// 95th percentile of that distance.
    pub innovation_p95_px: Option<f64>,
    /// Against what the simulator really showed, where the recording says it.
    pub score: Option<Score>,
}

/// A landmark in one frame.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The frame.
    pub frame: &'a DriveFrame,
    /// All that was seen in it.
    pub outcome: &'a Outcome,
    /// The landmark's best instance.
    pub best: &'a LandmarkOutcome,
}

/// The landmark `id` in every frame in which it was looked for.
pub fn observations<'a>(drive: &'a CameraDrive, id: &str) -> impl Iterator<Item = Observation<'a>> {
    let score = |landmark: &LandmarkOutcome| landmark.result.as_ref().map_or(-1.0, |seen| seen.score);
    drive.registered().filter_map(move |(frame, outcome)| {
        let instances = outcome.landmarks.iter().filter(|landmark| landmark.landmark == id);
        // Of equals the first, as the oldest instance comes first.
        let best = instances.reduce(|best, other| if score(other) > score(best) { other } else { best })?;
        Some(Observation { frame, outcome, best })
    })
}

impl LandmarkFigures {
    pub(super) fn of(id: &str, drive: &CameraDrive) -> Self {
        let mut misses: BTreeMap<String, u64> = BTreeMap::new();
        let (mut frames, mut measured) = (0, 0);
        let mut errors = [Vec::new(), Vec::new(), Vec::new()];
        let mut innovations = Vec::new();
        for Observation { best, .. } in observations(drive, id) {
            frames += 1;
            match &best.result {
                Ok(_) => measured += 1,
                Err(miss) => *misses.entry(miss.name().to_owned()).or_default() += 1,
            }
            if let Some(error) = prediction_error(best) {
                errors.iter_mut().zip(error).for_each(|(errors, error)| errors.push(error));
            }
            innovations.extend(best.innovation_px.map(f64::from).filter(|_| best.result.is_ok()));
        }
        let [x, y, area] = errors.map(|errors| Spread::of(&errors));
        Self {
            id: id.to_owned(),
            frames,
            measured,
            measured_rate: (frames > 0).then(|| measured as f64 / frames as f64),
            misses,
            prediction_error_x_px: x,
            prediction_error_y_px: y,
            prediction_error_area_px2: area,
            innovation_mean_px: Spread::of(&innovations).map(|spread| spread.mean),
            innovation_median_px: quantile(&mut innovations, 0.5),
            innovation_p95_px: quantile(&mut innovations, 0.95),
            score: scored(drive, id),
        }
    }
}

/// Measured minus predicted: x, y, area.
fn prediction_error(landmark: &LandmarkOutcome) -> Option<[f64; 3]> {
    let (seen, prior) = (landmark.result.as_ref().ok()?, landmark.prediction.as_ref()?);
    let difference = |measured: f32, predicted: f32| f64::from(measured) - f64::from(predicted);
    Some([
        difference(seen.centroid.x, prior.centroid.x),
        difference(seen.centroid.y, prior.centroid.y),
        difference(seen.area_px2, prior.area_px2),
    ])
}

/// The score over all registered frames of which the truth is recorded.
fn scored(drive: &CameraDrive, id: &str) -> Option<Score> {
    let (mut truth, mut claims) = (Truth::default(), BTreeMap::new());
    for ((frame, outcome), number) in drive.registered().zip(1..) {
        let Some(true_frame) = &frame.truth else { continue };
        let of_landmark = outcome.landmarks.iter().filter(|landmark| landmark.landmark == id);
        let claimed: Vec<Claim> = of_landmark.filter_map(Claim::of).collect();
        truth.frames.insert(number, meant_object(true_frame, id, &claimed));
        claims.insert(number, claimed);
    }
    (!truth.frames.is_empty()).then(|| score(&truth, &claims))
}
