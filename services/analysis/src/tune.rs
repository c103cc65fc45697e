//! Windows and tolerances tried on a sequence, one after the other, each judged by what it finds and what it claims
//! falsely.
//!
//! The judge is the truth where there is one. Without it, a measurement counts as right when it lies near the one
//! before, as objects do that move smoothly: persistence along the track (thesis 4.0.6) in place of truth.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use vision::{ColorStats, Landmark, LandmarkSet, SetVersion, WindowPx};
use waymark_proto::digest::landmark_digest;

use crate::input::{Input, InputError};
use crate::register::{Event, Job, register};
use crate::score::{Claim, score};
use crate::truth::Truth;

/// Sides of square windows that are tried, samples of the doubled grid.
const SIDES: [u16; 6] = [4, 6, 8, 12, 16, 24];
/// Factors on a tolerance that are tried.
const FACTORS: [f32; 5] = [0.5, 0.75, 1.5, 2.0, 3.0];
/// A false claim weighs as much as this many detections: a follower steers by what it is told.
const FALSE_CLAIM_WEIGHT: f64 = 5.0;
/// Measurements further apart than this many object sizes in consecutive frames are a jump.
const JUMP_SIZES: f32 = 1.0;

/// What a trial changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing: the landmark as it was given.
    Nothing,
    /// The window.
    Window,
    /// How far means may be off.
    MeanTolerance,
    /// How far variances may be off.
    VarianceTolerance,
}

/// One set of parameters and how it did.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What differs from the best trial before.
    pub change: Change,
    /// The parameters.
    pub landmark: Landmark,
    /// Part of the frames that show the object in which it was found.
    pub detection_rate: f64,
    /// Part of all judged frames with a claim that is wrong.
    pub false_rate: f64,
}

impl Trial {
    /// Larger is better.
    #[must_use]
    pub fn merit(&self) -> f64 {
        self.detection_rate - FALSE_CLAIM_WEIGHT * self.false_rate
    }
}

/// What tells right from wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Judge {
    /// Where the object really was.
    Truth(Truth),
    /// The measurement before.
    Persistence,
}

/// Tries windows, then tolerances of the means, then those of the variances, each with the best of what was tried
/// before. `on_trial` hears of each; the first is the landmark as given. Returns the best landmark.
///
/// # Errors
/// When the input cannot be opened.
pub fn tune(
    input: &Input,
    landmark: &Landmark,
    judge: &Judge,
    job: &Job,
    mut on_trial: impl FnMut(&Trial),
) -> Result<Trial, InputError> {
    let mut best = trial(input, landmark.clone(), Change::Nothing, judge, job)?;
    on_trial(&best);
    for change in [Change::Window, Change::MeanTolerance, Change::VarianceTolerance] {
        for candidate in candidates(&best.landmark, change) {
            let tried = trial(input, candidate, change, judge, job)?;
            on_trial(&tried);
            if tried.merit() > best.merit() {
                best = tried;
            }
        }
    }
    Ok(best)
}

/// How many trials [`tune`] makes at most.
#[must_use]
pub fn most_trials() -> usize {
    1 + SIDES.len() + 2 * FACTORS.len()
}

fn candidates(landmark: &Landmark, change: Change) -> Vec<Landmark> {
    let with_tolerance = |tolerance: ColorStats| Landmark { tolerance, ..landmark.clone() };
    let tolerance = landmark.tolerance;
    let scaled = |values: [f32; 3], factor: f32, most: f32| values.map(|value| (value * factor).min(most));
    match change {
        Change::Nothing => Vec::new(),
        Change::Window => SIDES
            .into_iter()
            .map(WindowPx::square)
            .filter(|window_px| *window_px != landmark.window_px)
            .map(|window_px| Landmark { window_px, ..landmark.clone() })
            .collect(),
        Change::MeanTolerance => FACTORS
            .map(|factor| {
                with_tolerance(ColorStats { mean: scaled(tolerance.mean, factor, 255.0), ..tolerance })
            })
            .to_vec(),
        Change::VarianceTolerance => FACTORS
            .map(|factor| {
                with_tolerance(ColorStats {
                    variance: scaled(tolerance.variance, factor, 16_256.25),
                    ..tolerance
                })
            })
            .to_vec(),
    }
}

fn trial(
    input: &Input,
    mut landmark: Landmark,
    change: Change,
    judge: &Judge,
    job: &Job,
) -> Result<Trial, InputError> {
    landmark.digest = landmark_digest(&landmark);
    let set = LandmarkSet { version: SetVersion::default(), landmarks: vec![Arc::new(landmark.clone())] };
    let job = Job { landmarks: Some(Arc::new(set)), ..job.clone() };
    let claims = claims(input, &job)?;
    let (detection_rate, false_rate) = match judge {
        Judge::Truth(truth) => judged_by_truth(truth, &claims),
        Judge::Persistence => judged_by_persistence(&claims),
    };
    Ok(Trial { change, landmark, detection_rate, false_rate })
}

fn claims(input: &Input, job: &Job) -> Result<BTreeMap<u64, Vec<Claim>>, InputError> {
    let mut claims: BTreeMap<u64, Vec<Claim>> = BTreeMap::new();
    let frames = input.open()?;
    let Ok(_) = register(vec![(input.clone(), frames)], job, |_, event| -> Result<(), Infallible> {
        if let Event::Registered { frame, outcome, .. } = event {
            claims.entry(frame).or_default().extend(outcome.landmarks.iter().filter_map(Claim::of));
        }
        Ok(())
    });
    Ok(claims)
}

fn judged_by_truth(truth: &Truth, claims: &BTreeMap<u64, Vec<Claim>>) -> (f64, f64) {
    let scored = score(truth, claims);
    let frames = scored.frames as f64;
    let wrong = scored.false_rate.unwrap_or(0.0) * frames + scored.false_when_absent as f64;
    let judged = (frames + scored.absent_frames as f64).max(1.0);
    (scored.detection_rate.unwrap_or(0.0), wrong / judged)
}

fn judged_by_persistence(claims: &BTreeMap<u64, Vec<Claim>>) -> (f64, f64) {
    let best = |claims: &Vec<Claim>| claims.iter().copied().max_by(|a, b| a.score.total_cmp(&b.score));
    let track: Vec<Option<Claim>> = claims.values().map(best).collect();
    let jumps = |pair: &&[Option<Claim>; 2]| match pair {
        [Some(before), Some(after)] => {
            let size_px = before.area_px2.max(after.area_px2).max(1.0).sqrt();
            before.centre.distance_px(after.centre) > JUMP_SIZES * size_px
        }
        _ => false,
    };
    let frames = track.len().max(1) as f64;
    let claimed = track.iter().flatten().count();
    let jumped = track.array_windows().filter(jumps).count();
    (claimed.saturating_sub(jumped) as f64 / frames, jumped as f64 / frames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vision::PointPx;

    fn claim(x: f32) -> Vec<Claim> {
        vec![Claim { centre: PointPx::new(x, 50.0), area_px2: 100.0, score: 0.9 }]
    }

    #[test]
    fn a_jump_counts_against_and_a_gap_does_not() {
        let claims = BTreeMap::from([
            (1, claim(10.0)),
            (2, claim(12.0)),
            (3, vec![]),
            (4, claim(16.0)),
            (5, claim(90.0)),
        ]);
        assert_eq!(judged_by_persistence(&claims), (0.6, 0.2));
        assert_eq!(judged_by_persistence(&BTreeMap::new()), (0.0, 0.0));
    }

    #[test]
    fn candidates_stay_within_what_a_landmark_may_say() {
        let landmark = Landmark {
            id: "red".to_owned(),
            revision: 1,
            window_px: WindowPx::square(12),
            shades: vec![ColorStats::default()],
            tolerance: ColorStats::uniform(200.0, 9_000.0),
            shape: vision::ShapeClass::Any,
            size_m: None,
            digest: vision::Digest::default(),
        };
        for change in [Change::Window, Change::MeanTolerance, Change::VarianceTolerance] {
            for candidate in candidates(&landmark, change) {
                assert_ne!(candidate, landmark);
                assert!(candidate.tolerance.mean[0] <= 255.0 && candidate.tolerance.variance[0] <= 16_256.25);
            }
        }
    }
}
