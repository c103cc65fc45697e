//! Measurements against truth, with one rule for every sequence.
//!
//! A frame counts when at least half of the object is visible. Where several instances are reported, the best-scored
//! one stands for the frame; it is correct when its centre lies within the truth's tolerance. Frames in which less
//! than a twentieth of the object is visible are absent frames: any claim there is false.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use vision::{LandmarkOutcome, PointPx, Sighting};

use crate::figures::Spread;
use crate::truth::{TrueObject, Truth};

/// A measurement of the scored landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// Centre.
    pub centre: PointPx,
    /// Area, px².
    pub area_px2: f32,
    /// Belief, 0..1.
    pub score: f32,
}

impl Claim {
    /// What an outcome claims, if anything.
    #[must_use]
    pub fn of(outcome: &LandmarkOutcome) -> Option<Self> {
        outcome.result.as_ref().ok().map(Self::from)
    }
}

impl From<&Sighting> for Claim {
    fn from(seen: &Sighting) -> Self {
        Self { centre: seen.centroid, area_px2: seen.area_px2, score: seen.score }
    }
}

/// How well the measurements agree with the truth. Rates are parts of `frames`; figures without data are null.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Frames that count.
    pub frames: u64,
    /// Frames measured correctly.
    pub detection_rate: Option<f64>,
    /// Frames whose best claim is somewhere else.
    pub false_rate: Option<f64>,
    /// Frames without a claim.
    pub miss_rate: Option<f64>,
    /// Wrong claims beside the best one, a frame.
    pub extra_per_frame: Option<f64>,
    /// Median distance of correct centres from the truth.
    pub centre_median_px: Option<f64>,
    /// Mean of that distance.
    pub centre_mean_px: Option<f64>,
    /// Their 95th percentile.
    pub centre_p95_px: Option<f64>,
    /// Median over correct frames of |area / true area − 1|.
    pub area_abs_median_relative: Option<f64>,
    /// Frames without the object.
    pub absent_frames: u64,
    /// Those of them in which something was claimed.
    pub false_when_absent: u64,
}

#[derive(Default)]
struct Counts {
    frames: u64,
    detected: u64,
    wrong: u64,
    missed: u64,
    extra: u64,
    absent: u64,
    wrong_when_absent: u64,
    errors_px: Vec<f64>,
    area_errors: Vec<f64>,
}

/// Scores the claims of each frame.
#[must_use]
pub fn score(truth: &Truth, claims: &BTreeMap<u64, Vec<Claim>>) -> Score {
    let mut counts = Counts::default();
    for (frame, object) in &truth.frames {
        let claims = claims.get(frame).map_or(&[][..], Vec::as_slice);
        if object.visible >= 0.5 {
            counts.count_visible(object, claims);
        } else if object.visible < 0.05 {
            counts.absent += 1;
            counts.wrong_when_absent += u64::from(!claims.is_empty());
        }
    }
    counts.into_score()
}

impl Counts {
    fn count_visible(&mut self, object: &TrueObject, claims: &[Claim]) {
        self.frames += 1;
        let Some(best) =
            claims.iter().reduce(|best, claim| if claim.score > best.score { claim } else { best })
        else {
            self.missed += 1;
            return;
        };
        let off_px = |claim: &Claim| claim.centre.distance_px(object.centre);
        let is_wrong = |claim: &Claim| off_px(claim) > object.tolerance_px;
        let wrong = claims.iter().filter(|claim| is_wrong(claim)).count() as u64;
        self.extra += wrong - u64::from(is_wrong(best));
        if is_wrong(best) {
            self.wrong += 1;
            return;
        }
        self.detected += 1;
        self.errors_px.push(f64::from(off_px(best)));
        if let Some(area_px2) = object.area_px2 {
            self.area_errors.push(f64::from((best.area_px2 / area_px2 - 1.0).abs()));
        }
    }

    fn into_score(mut self) -> Score {
        let rate = |count: u64| (self.frames > 0).then(|| count as f64 / self.frames as f64);
        Score {
            frames: self.frames,
            detection_rate: rate(self.detected),
            false_rate: rate(self.wrong),
            miss_rate: rate(self.missed),
            extra_per_frame: rate(self.extra),
            centre_median_px: quantile(&mut self.errors_px, 0.5),
            centre_mean_px: Spread::of(&self.errors_px).map(|spread| spread.mean),
            centre_p95_px: quantile(&mut self.errors_px, 0.95),
            area_abs_median_relative: quantile(&mut self.area_errors, 0.5),
            absent_frames: self.absent,
            false_when_absent: self.wrong_when_absent,
        }
    }
}

/// The nearest-rank quantile; the median of an even count is the mean of its two middle values.
pub(crate) fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if share == 0.5 && values.len().is_multiple_of(2) && middle > 0 {
        return Some((values[middle - 1] + values[middle]) / 2.0);
    }
    let rank = (share * values.len() as f64).ceil() as usize;
    values.get(rank.saturating_sub(1)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(visible: f32) -> TrueObject {
        TrueObject { centre: PointPx::new(100.0, 100.0), area_px2: Some(100.0), visible, tolerance_px: 5.0 }
    }

    fn claim(x: f32, score: f32) -> Claim {
        Claim { centre: PointPx::new(x, 100.0), area_px2: 110.0, score }
    }

    #[test]
    fn every_frame_is_one_of_detected_wrong_and_missed() {
        let visible = [1.0, 1.0, 0.6, 1.0, 0.3, 0.0, 0.0];
        let truth = Truth { frames: (1..).zip(visible.map(object)).collect() };
        let claims = BTreeMap::from([
            (1, vec![claim(101.0, 0.9)]),
            (2, vec![claim(150.0, 0.9), claim(100.0, 0.2)]),
            (3, vec![claim(103.0, 0.5), claim(150.0, 0.1)]),
            (5, vec![claim(100.0, 0.5)]),
            (7, vec![claim(100.0, 0.5)]),
        ]);
        let score = score(&truth, &claims);
        assert_eq!(score.frames, 4);
        assert_eq!(
            (score.detection_rate, score.false_rate, score.miss_rate, score.extra_per_frame),
            (Some(0.5), Some(0.25), Some(0.25), Some(0.25))
        );
        assert_eq!((score.centre_median_px, score.centre_p95_px), (Some(2.0), Some(3.0)));
        assert!((score.area_abs_median_relative.unwrap() - 0.1).abs() < 1e-6);
        assert_eq!((score.absent_frames, score.false_when_absent), (2, 1));
    }

    #[test]
    fn nothing_to_score_is_not_zero() {
        assert_eq!(score(&Truth::default(), &BTreeMap::new()), Score::default());
    }
}
