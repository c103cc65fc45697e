//! Why a landmark was or was not registered in a frame, statistic by statistic.
//!
//! The best place is where it was registered, and otherwise where the window comes nearest to a match; there the six
//! statistics are set against the descriptor's, with the tolerances that decide.

use std::sync::Arc;

use crate::follow::{Follow, FollowOptions, FrameStamp, Mode, report};
use crate::frame::Frame;
use crate::geometry::{PointPx, Segment};
use crate::landmark::{ColorStats, Landmark, LandmarkSet, SetVersion};
use crate::nearest::{nearest_match, worst_statistic};
use crate::outcome::{LandmarkOutcome, Miss, Sighting, Statistic};
use crate::probe::NoProbe;

/// One of the six statistics at the best place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Which one.
    pub statistic: Statistic,
    /// As observed: levels or levels².
    pub observed: f32,
    /// The descriptor's, of the shade that comes nearest.
    pub expected: f32,
    /// How far it may be off.
    pub tolerance: f32,
    /// How far it is off, in tolerances; above 1 is a failure.
    pub excess: f32,
}

/// What was seen of one landmark in one frame, and what decided.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Centre of the best place; `None` where the frame is smaller than the window.
    pub at: Option<PointPx>,
    /// Which of the landmark's shades comes nearest there, an index.
    pub shade: usize,
    /// The six statistics there: means of R, G, B, then variances.
    pub statistics: Vec<Comparison>,
    /// Outline of what was registered.
    pub outline: Vec<PointPx>,
    /// Its straight pieces.
    pub segments: Vec<Segment>,
    /// How well it fits the landmark's shape class, 0..1; `None` where nothing was registered or it is too small to
    /// tell.
    pub shape_score: Option<f32>,
    /// The whole outcome: registered, or the reason why not.
    pub outcome: LandmarkOutcome,
    /// Further objects that were registered, with a lower score than the one explained, best first.
    pub others: Vec<LandmarkOutcome>,
}

impl Explanation {
    /// The statistics outside their tolerance, worst first.
    #[must_use]
    pub fn failures(&self) -> Vec<Comparison> {
        let mut failures: Vec<Comparison> =
            self.statistics.iter().copied().filter(|s| s.excess > 1.0).collect();
        failures.sort_by(|a, b| b.excess.total_cmp(&a.excess));
        failures
    }

    /// Why it was not registered, in words; `None` when it was.
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        let miss = self.outcome.result.as_ref().err()?;
        Some(match (miss, self.failures().as_slice()) {
            (Miss::NoColour { .. }, []) => {
                "single windows fit its statistics, but nothing stands out from its surroundings as the object"
                    .to_owned()
            }
            (Miss::NoColour { .. }, [worst, ..]) => format!(
                "no window matched; the nearest one fails by {} most, {:.1} times what is allowed",
                worst.statistic.in_words(),
                worst.excess
            ),
            (Miss::TooSmall, _) => "the object or the picture is smaller than the averaging window".to_owned(),
            (Miss::WrongShape { score }, _) => {
                format!("its colour was there, but the outline fits only to {score:.2}")
            }
            (Miss::OutsideGate { innovation_px }, _) => format!("what matched was {innovation_px:.0} px off"),
            (Miss::Occluded { visible }, _) => format!("only {:.0} % of it can be seen", 100.0 * visible),
            (Miss::OutsideFrame, _) => "it is expected outside the picture".to_owned(),
            (Miss::Skipped, _) => "not looked for: the bound on work per frame was reached".to_owned(),
        })
    }
}

impl Statistic {
    /// `mean red`, `variance blue`.
    #[must_use]
    pub fn in_words(self) -> String {
        let (kind, channel) = match self {
            Self::Mean(channel) => ("mean", channel),
            Self::Variance(channel) => ("variance", channel),
        };
        format!("{kind} {}", ["red", "green", "blue"].get(usize::from(channel)).unwrap_or(&"?"))
    }
}

/// Explains what `mode` makes of `landmark` in `frame`, nothing known from earlier frames.
///
/// A miss is looked into window by window, which takes some 50 ms for a frame of 640×480.
#[must_use]
pub fn explain(frame: &Frame, landmark: &Landmark, mode: Mode) -> Explanation {
    let mut outcomes = first_outcomes(frame, landmark, mode).into_iter();
    let outcome = outcomes.next().unwrap_or_else(|| report::missed(landmark, 0, Miss::Skipped));
    let explanation = match &outcome.result {
        Ok(sighting) => of_sighting(landmark, sighting.clone(), outcome),
        Err(_) => of_miss(frame, landmark, outcome),
    };
    Explanation { others: outcomes.filter(|other| other.result.is_ok()).collect(), ..explanation }
}

/// What is said of a first frame, the best score first.
fn first_outcomes(frame: &Frame, landmark: &Landmark, mode: Mode) -> Vec<LandmarkOutcome> {
    let landmarks = vec![Arc::new(landmark.clone())];
    let set = LandmarkSet { version: SetVersion::default(), landmarks };
    let mut follow = Follow::new(FollowOptions { mode, ..FollowOptions::default() }, set);
    let mut outcomes = follow.on_frame(frame, FrameStamp::default(), &mut NoProbe).landmarks;
    let score = |row: &LandmarkOutcome| row.result.as_ref().map_or(-1.0, |sighting| sighting.score);
    outcomes.sort_by(|a, b| score(b).total_cmp(&score(a)));
    outcomes
}

fn of_sighting(landmark: &Landmark, sighting: Sighting, outcome: LandmarkOutcome) -> Explanation {
    let (shade, statistics) = nearest_shade(landmark, &sighting.observed);
    Explanation {
        at: Some(sighting.centroid),
        shade,
        statistics,
        outline: sighting.outline,
        segments: sighting.segments,
        shape_score: sighting.shape_score,
        outcome,
        others: Vec::new(),
    }
}

fn of_miss(frame: &Frame, landmark: &Landmark, mut outcome: LandmarkOutcome) -> Explanation {
    let best = nearest_match(frame, landmark, None);
    if let Err(Miss::NoColour { best: unknown }) = &mut outcome.result {
        *unknown = best;
    }
    let (shade, statistics) =
        best.map_or_else(|| (0, Vec::new()), |best| nearest_shade(landmark, &best.observed));
    let (outline, segments) = (Vec::new(), Vec::new());
    Explanation {
        at: best.map(|best| best.at),
        shade,
        statistics,
        outline,
        segments,
        shape_score: None,
        outcome,
        others: Vec::new(),
    }
}

/// The shade whose worst statistic is the least far off, and all six against it.
fn nearest_shade(landmark: &Landmark, observed: &ColorStats) -> (usize, Vec<Comparison>) {
    let excess = |shade: &ColorStats| worst_statistic(observed, shade, &landmark.tolerance).1;
    let with_excess = landmark.shades.iter().map(excess).enumerate();
    let Some((at, _)) = with_excess.min_by(|a, b| a.1.total_cmp(&b.1)) else { return (0, Vec::new()) };
    (at, comparisons(observed, &landmark.shades[at], &landmark.tolerance))
}

fn comparisons(observed: &ColorStats, expected: &ColorStats, tolerance: &ColorStats) -> Vec<Comparison> {
    let compare = |statistic, observed: f32, expected: f32, tolerance: f32| {
        let off = (observed - expected).abs();
        let excess = if off == 0.0 { 0.0 } else { off / tolerance.max(0.0) };
        Comparison { statistic, observed, expected, tolerance, excess }
    };
    let mean = |channel: u8| {
        let c = usize::from(channel);
        compare(Statistic::Mean(channel), observed.mean[c], expected.mean[c], tolerance.mean[c])
    };
    let variance = |channel: u8| {
        let c = usize::from(channel);
        compare(
            Statistic::Variance(channel),
            observed.variance[c],
            expected.variance[c],
            tolerance.variance[c],
        )
    };
    (0..3).map(mean).chain((0..3).map(variance)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landmark::{ShapeClass, WindowPx};

    fn landmark() -> Landmark {
        Landmark {
            id: "red".into(),
            revision: 1,
            window_px: WindowPx::square(8),
            shades: vec![
                ColorStats { mean: [20.0, 20.0, 20.0], variance: [0.0; 3] },
                ColorStats { mean: [200.0, 40.0, 30.0], variance: [0.0; 3] },
            ],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Any,
            size_m: None,
            digest: crate::landmark::Digest::default(),
        }
    }

    fn frame(block: [u8; 3]) -> Frame {
        let pixel = |x: usize, y: usize| {
            if (20..40).contains(&x) && (10..30).contains(&y) { block } else { [90, 120, 160] }
        };
        let rgb = (0..48).flat_map(|y| (0..64).flat_map(move |x| pixel(x, y))).collect();
        Frame::from_rgb(64, 48, rgb).unwrap()
    }

    #[test]
    fn what_matches_is_explained_by_its_own_shade() {
        for mode in [Mode::Faithful, Mode::Adaptive] {
            let explanation = explain(&frame([203, 38, 30]), &landmark(), mode);
            assert!(explanation.outcome.result.is_ok(), "{mode:?}");
            assert_eq!(explanation.shade, 1);
            assert_eq!(explanation.statistics.len(), 6);
            assert!(explanation.failures().is_empty(), "{:?}", explanation.failures());
            assert!(explanation.others.is_empty());
            assert_eq!(explanation.outcome.adaptation.is_some(), mode == Mode::Adaptive);
        }
    }

    #[test]
    fn a_miss_names_the_statistic_that_failed_and_by_how_much() {
        let explanation = explain(&frame([200, 40, 75]), &landmark(), Mode::Faithful);
        let failures = explanation.failures();
        assert_eq!(failures.len(), 1);
        assert_eq!(failures[0].statistic, Statistic::Mean(2));
        assert!((failures[0].excess - 3.0).abs() < 1e-3);
        let Err(Miss::NoColour { best: Some(best) }) = explanation.outcome.result else { panic!() };
        assert_eq!(best.worst, Statistic::Mean(2));
    }

    #[test]
    fn a_frame_smaller_than_the_window_has_no_best_place() {
        let tiny = Frame::from_rgb(2, 2, vec![0; 12]).unwrap();
        let explanation = explain(&tiny, &landmark(), Mode::Faithful);
        assert_eq!(explanation.at, None);
        assert_eq!(explanation.outcome.result, Err(Miss::TooSmall));
    }
}
