//! How well the follower did, against what the simulator really showed.

use std::collections::{BTreeMap, HashMap, VecDeque};

use analysis::score::{Claim, Score, score};
use analysis::truth::{self, Truth, meant_object};
use vision::PointPx;
use waymark_proto::v1::{self, LandmarkResult, Registration, landmark_result};

/// Truths whose registration may still come; beyond it the oldest is forgotten.
const WAITING_FRAMES: usize = 256;
/// Frames that are scored, an hour of them: of a longer drive the last ones.
const SCORED_FRAMES: usize = 108_000;

/// Pairs truths with registrations by sequence, and keeps what scoring needs.
#[derive(Debug, Default)]
pub(crate) struct Scorer {
    truths: HashMap<u64, v1::Truth>,
    order: VecDeque<u64>,
    landmarks: BTreeMap<String, Drive>,
    latencies_ms: VecDeque<f64>,
    frames: u64,
}

/// One landmark over the drive.
#[derive(Debug, Default)]
struct Drive {
    truth: Truth,
    claims: BTreeMap<u64, Vec<Claim>>,
}

impl Scorer {
    /// What the simulator showed in a frame.
    pub(crate) fn truth(&mut self, truth: v1::Truth) {
        if self.order.len() == WAITING_FRAMES
            && let Some(oldest) = self.order.pop_front()
        {
            self.truths.remove(&oldest);
        }
        self.order.push_back(truth.sequence);
        self.truths.insert(truth.sequence, truth);
    }

    /// What the follower saw in a frame, `latency_ms` after its capture.
    pub(crate) fn registration(&mut self, registration: &Registration, latency_ms: f64) {
        self.frames += 1;
        push_bounded(&mut self.latencies_ms, latency_ms);
        let Some(truth) = self.truths.remove(&registration.sequence) else { return };
        let mut claims: BTreeMap<&str, Vec<Claim>> = BTreeMap::new();
        for result in &registration.landmarks {
            claims.entry(&result.landmark).or_default().extend(claim(result));
        }
        for (landmark, claims) in claims {
            let drive = self.landmarks.entry(landmark.to_owned()).or_default();
            drive.add(registration.sequence, meant_object(&truth, landmark, &claims), claims);
        }
    }

    /// Registered frames.
    pub(crate) fn frames(&self) -> u64 {
        self.frames
    }

    /// Every landmark's score, by id.
    pub(crate) fn landmarks(&self) -> Vec<(String, Score)> {
        let scored = |(id, drive): (&String, &Drive)| (id.clone(), score(&drive.truth, &drive.claims));
        self.landmarks.iter().map(scored).collect()
    }

    /// The smallest latency that at least the part `p` of all frames does not exceed, capture to result.
    pub(crate) fn latency_ms(&self, p: f64) -> Option<f64> {
        let mut sorted: Vec<f64> = self.latencies_ms.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let rank = (p * sorted.len() as f64).ceil() as usize;
        sorted.get(rank.saturating_sub(1)).copied()
    }
}

impl Drive {
    fn add(&mut self, frame: u64, object: truth::TrueObject, claims: Vec<Claim>) {
        if self.truth.frames.len() == SCORED_FRAMES {
            self.truth.frames.pop_first();
            self.claims.pop_first();
        }
        self.truth.frames.insert(frame, object);
        self.claims.insert(frame, claims);
    }
}

fn push_bounded(values: &mut VecDeque<f64>, value: f64) {
    if values.len() == SCORED_FRAMES {
        values.pop_front();
    }
    values.push_back(value);
}

fn claim(result: &LandmarkResult) -> Option<Claim> {
    let Some(landmark_result::Result::Sighting(sighting)) = &result.result else { return None };
    let centroid = sighting.centroid?;
    let centre = PointPx::new(centroid.x_px, centroid.y_px);
    Some(Claim { centre, area_px2: sighting.area_px2, score: sighting.score })
}

#[cfg(test)]
mod tests {
    use super::*;
    use waymark_proto::v1::{Point, Sighting, TrueObject};

    fn truth(sequence: u64, objects: &[(&str, f64)]) -> v1::Truth {
        let object = |&(object, x_px): &(&str, f64)| TrueObject {
            object: object.to_owned(),
            x_px,
            y_px: 50.0,
            area_px2: 400.0,
            visible: 1.0,
            ..Default::default()
        };
        v1::Truth { sequence, objects: objects.iter().map(object).collect(), ..Default::default() }
    }

    fn seen(sequence: u64, landmark: &str, x_px: Option<f32>) -> Registration {
        let result = x_px.map(|x_px| {
            let centroid = Some(Point { x_px, y_px: 50.0 });
            landmark_result::Result::Sighting(Sighting { centroid, score: 0.9, ..Default::default() })
        });
        let landmark = LandmarkResult { landmark: landmark.to_owned(), result, ..Default::default() };
        Registration { sequence, landmarks: vec![landmark], ..Default::default() }
    }

    #[test]
    fn right_wrong_and_missed_sightings_are_told_apart() {
        let mut scorer = Scorer::default();
        for (sequence, x_px) in [(1, Some(102.0)), (2, Some(300.0)), (3, None), (4, Some(100.0))] {
            scorer.truth(truth(sequence, &[("red", 100.0)]));
            scorer.registration(&seen(sequence, "red", x_px), 4.0);
        }
        let (id, score) = &scorer.landmarks()[0];
        assert_eq!((&**id, score.detection_rate, score.false_rate), ("red", Some(0.5), Some(0.25)));
        assert_eq!(scorer.latency_ms(0.99), Some(4.0));
    }

    #[test]
    fn one_landmark_may_stand_for_many_objects() {
        let mut scorer = Scorer::default();
        scorer.truth(truth(1, &[("sign-1", 10.0), ("sign-2", 200.0)]));
        scorer.registration(&seen(1, "sign", Some(201.0)), 1.0);
        assert_eq!(scorer.landmarks()[0].1.detection_rate, Some(1.0));
    }

    #[test]
    fn a_frame_without_truth_is_not_scored() {
        let mut scorer = Scorer::default();
        scorer.registration(&seen(9, "red", Some(1.0)), 1.0);
        assert_eq!(scorer.frames(), 1);
        assert!(scorer.landmarks().is_empty());
    }
}
