//! What tells right from wrong.
//!
//! The judge is the truth where there is one. Without it, a measurement counts as right when it lies near the one
//! before, as objects do that move smoothly: persistence along the track (thesis 4.0.6) in place of truth.

use std::collections::BTreeMap;

use vision::{ColorStats, Landmark};

use crate::score::{Claim, score};
use crate::truth::Truth;

/// Measurements further apart than this many object sizes in consecutive frames are a jump.
const JUMP_SIZES: f32 = 1.0;

/// What was claimed in each frame, with the statistics seen there.
pub(super) type Sightings = BTreeMap<u64, Vec<(Claim, ColorStats)>>;

/// What tells right from wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Judge {
    /// Where the object really was.
    Truth(Truth),
    /// The measurement before.
    Persistence,
}

/// What came of one landmark over all inputs.
#[derive(Debug, Default)]
pub(super) struct Tally {
    /// Frames that show the object, or may.
    frames: f64,
    found: f64,
    /// Frames that were judged.
    judged: f64,
    wrong: f64,
    /// The right sighting that is furthest from every shade, and how far, in tolerances.
    furthest: Option<(f32, ColorStats)>,
}

impl Tally {
    pub(super) fn add(&mut self, judge: &Judge, sightings: &Sightings, landmark: &Landmark) {
        let right = match judge {
            Judge::Truth(truth) => self.add_by_truth(truth, sightings),
            Judge::Persistence => self.add_by_persistence(sightings),
        };
        for observed in right {
            let away = distance(landmark, &observed);
            if self.furthest.is_none_or(|(furthest, _)| away > furthest) {
                self.furthest = Some((away, observed));
            }
        }
    }

    pub(super) fn detection_rate(&self) -> f64 {
        self.found / self.frames.max(1.0)
    }

    pub(super) fn false_rate(&self) -> f64 {
        self.wrong / self.judged.max(1.0)
    }

    pub(super) fn furthest(&self) -> Option<ColorStats> {
        self.furthest.map(|(_, observed)| observed)
    }

    fn add_by_truth(&mut self, truth: &Truth, sightings: &Sightings) -> Vec<ColorStats> {
        let claims = sightings
            .iter()
            .map(|(frame, seen)| (*frame, seen.iter().map(|(claim, _)| *claim).collect()))
            .collect();
        let scored = score(truth, &claims);
        let frames = scored.frames as f64;
        self.frames += frames;
        self.found += scored.detection_rate.unwrap_or(0.0) * frames;
        self.judged += frames + scored.absent_frames as f64;
        self.wrong += scored.false_rate.unwrap_or(0.0) * frames + scored.false_when_absent as f64;
        let there = |frame: &u64, claim: &Claim| {
            let object = truth.frames.get(frame);
            object.is_some_and(|object| claim.centre.distance_px(object.centre) <= object.tolerance_px)
        };
        let all = sightings.iter().flat_map(|(frame, seen)| seen.iter().map(move |seen| (frame, seen)));
        all.filter(|(frame, (claim, _))| there(frame, claim)).map(|(_, (_, observed))| *observed).collect()
    }

    fn add_by_persistence(&mut self, sightings: &Sightings) -> Vec<ColorStats> {
        let best = |seen: &Vec<(Claim, ColorStats)>| {
            seen.iter().copied().max_by(|(a, _), (b, _)| a.score.total_cmp(&b.score))
        };
        let track: Vec<Option<(Claim, ColorStats)>> = sightings.values().map(best).collect();
        let jumped = track.array_windows().filter(|[before, after]| is_jump(*before, *after)).count();
        let claimed = track.iter().flatten().count();
        self.frames += track.len() as f64;
        self.judged += track.len() as f64;
        self.found += claimed.saturating_sub(jumped) as f64;
        self.wrong += jumped as f64;
        let steady =
            track.array_windows().filter(|[before, after]| before.is_some() && !is_jump(*before, *after));
        steady.filter_map(|[_, after]| after.map(|(_, observed)| observed)).collect()
    }
}

fn is_jump(before: Option<(Claim, ColorStats)>, after: Option<(Claim, ColorStats)>) -> bool {
    let (Some((before, _)), Some((after, _))) = (before, after) else { return false };
    let size_px = before.area_px2.max(after.area_px2).max(1.0).sqrt();
    before.centre.distance_px(after.centre) > JUMP_SIZES * size_px
}

/// How far the means of `observed` are from the nearest shade, in tolerances of the worst channel.
fn distance(landmark: &Landmark, observed: &ColorStats) -> f32 {
    let from = |shade: &ColorStats| {
        let channels = (0..3).map(|channel| {
            let tolerance = landmark.tolerance.mean[channel].max(1.0);
            (observed.mean[channel] - shade.mean[channel]).abs() / tolerance
        });
        channels.fold(0.0, f32::max)
    };
    landmark.shades.iter().map(from).fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::TrueObject;
    use vision::{PointPx, WindowPx};

    fn seen(x: f32, level: f32) -> Vec<(Claim, ColorStats)> {
        let claim = Claim { centre: PointPx::new(x, 50.0), area_px2: 100.0, score: 0.9 };
        vec![(claim, ColorStats::uniform(level, 0.0))]
    }

    fn landmark() -> Landmark {
        Landmark {
            id: "red".to_owned(),
            revision: 1,
            window_px: WindowPx::square(12),
            shades: vec![ColorStats::uniform(100.0, 0.0)],
            tolerance: ColorStats::uniform(10.0, 0.0),
            shape: vision::ShapeClass::Any,
            size_m: None,
            digest: vision::Digest::default(),
        }
    }

    #[test]
    fn a_jump_counts_against_and_a_gap_does_not() {
        let sightings = Sightings::from([
            (1, seen(10.0, 100.0)),
            (2, seen(12.0, 120.0)),
            (3, vec![]),
            (4, seen(16.0, 110.0)),
            (5, seen(90.0, 250.0)),
        ]);
        let mut tally = Tally::default();
        assert_eq!((tally.detection_rate(), tally.false_rate()), (0.0, 0.0));
        tally.add(&Judge::Persistence, &sightings, &landmark());
        assert_eq!((tally.detection_rate(), tally.false_rate()), (0.6, 0.2));
        assert_eq!(tally.furthest().unwrap().mean[0], 120.0, "what it jumped to teaches nothing");
    }

    #[test]
    fn inputs_count_by_their_frames() {
        let object =
            TrueObject { centre: PointPx::new(10.0, 50.0), area_px2: None, visible: 1.0, tolerance_px: 3.0 };
        let truth = Truth { frames: (1..=4).map(|frame| (frame, object)).collect() };
        let mut tally = Tally::default();
        let hits: Sightings = (1..=4).map(|frame| (frame, seen(10.0, 100.0))).collect();
        tally.add(&Judge::Truth(truth.clone()), &hits, &landmark());
        tally.add(&Judge::Truth(truth), &Sightings::from([(1, seen(60.0, 240.0))]), &landmark());
        assert_eq!((tally.detection_rate(), tally.false_rate()), (0.5, 0.125));
        assert_eq!(tally.furthest().unwrap().mean[0], 100.0);
    }
}
