//! One landmark in one frame as the thesis does it: the whole frame, fixed statistics, no gate. What was seen before
//! only numbers the instances and is reported as the prior.

use super::Scene;
use super::report::Report;
use super::state::{LandmarkState, Track};
use crate::adaptive::Light;
use crate::gate::search_gate;
use crate::landmark::Landmark;
use crate::outcome::{LandmarkOutcome, Miss, Prediction, Sighting};
use crate::predict::{Fix, Predictor};

/// A further object of the same landmark needs this part of the best one's score.
const FURTHER_PART: f32 = 0.75;
/// Objects unseen for so many frames are forgotten.
const GIVE_UP_AFTER: u32 = 45;

/// Updates what is known of one landmark by what was seen of it.
pub(super) fn landmark(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    seen: Result<Vec<Sighting>, Miss>,
    mut report: Report<'_>,
) {
    let miss = seen.as_ref().err().copied().unwrap_or(Miss::NoColour { best: None });
    let mut seen = seen.unwrap_or_default();
    let least = FURTHER_PART * seen.first().map_or(0.0, |best| best.score);
    let kept = seen.iter().take_while(|sighting| sighting.score >= least).count();
    let kept = kept.min(scene.options.max_instances as usize);
    seen.drain(kept..).for_each(|sighting| report.workspace.recycle_sighting(sighting));
    for track in &mut state.tracks {
        let prediction = track.predictor.predict(scene.captured_at);
        let outcome = match take_nearest(&prediction, &mut seen) {
            Some(sighting) => advance(scene, landmark, track, &prediction, sighting, &mut report),
            None => {
                track.misses += 1;
                report.missed(landmark, track.instance, miss)
            }
        };
        report.outcomes.push(LandmarkOutcome { prediction: Some(prediction), ..outcome });
    }
    state.tracks.retain(|track| track.misses < GIVE_UP_AFTER);
    for sighting in seen.drain(..) {
        let outcome = begin(scene, landmark, state, sighting, &mut report);
        report.outcomes.push(outcome);
    }
    report.workspace.recycle(seen);
    if report.outcomes.is_empty() {
        let outcome = report.missed(landmark, 0, miss);
        report.outcomes.push(outcome);
    }
}

/// The sighting nearest to a prior, when it can be the same object.
fn take_nearest(prediction: &Prediction, seen: &mut Vec<Sighting>) -> Option<Sighting> {
    let gate = search_gate(prediction);
    let near = |sighting: &Sighting| sighting.centroid.distance_px(prediction.centroid);
    let inside = seen.iter().enumerate().filter(|(_, sighting)| gate.contains(sighting.centroid));
    let at = inside.min_by(|a, b| near(a.1).total_cmp(&near(b.1))).map(|(at, _)| at)?;
    Some(seen.remove(at))
}

fn advance(
    scene: &Scene<'_>,
    landmark: &Landmark,
    track: &mut Track,
    prediction: &Prediction,
    sighting: Sighting,
    report: &mut Report<'_>,
) -> LandmarkOutcome {
    track.misses = 0;
    track.sightings += 1;
    track.predictor.update(fix(scene, &sighting));
    let innovation_px = Some(prediction.centroid.distance_px(sighting.centroid));
    LandmarkOutcome { innovation_px, ..report.measured(landmark, track.instance, sighting) }
}

fn begin(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    sighting: Sighting,
    report: &mut Report<'_>,
) -> LandmarkOutcome {
    let predictor = Predictor::new(scene.options.prediction, fix(scene, &sighting));
    let track = state.begin(predictor, Light::AS_LEARNED, sighting.score);
    report.measured(landmark, track.instance, sighting)
}

fn fix(scene: &Scene<'_>, sighting: &Sighting) -> Fix {
    Fix { captured_at: scene.captured_at, centroid: sighting.centroid, area_px2: sighting.area_px2 }
}
