//! One landmark in one frame: what was found updates what is known, and becomes the outcome.

use super::pursue::Pursuit;
use super::report::Report;
use super::state::{LandmarkState, Motion, Track};
use super::{Scene, reason};
use crate::adaptive::memory::List;
use crate::adaptive::{Candidate, Tracer};
use crate::gate::innovation_gate;
use crate::landmark::Landmark;
use crate::outcome::{Adaptation, LandmarkOutcome, Miss, Prediction, Sighting};
use crate::predict::{Fix, Predictor};
use crate::register::ShapeVeto;

/// The first sighting of an object needs this score.
const FIRST_SCORE: f32 = 0.30;
/// A further object of the same landmark needs this score
const FURTHER_SCORE: f32 = 0.5;
/// and this part of the best one's score.
const FURTHER_PART: f32 = 0.75;
/// and this part of the area of the one that is known best: it may be three times as far away,
const FURTHER_SIZE: f32 = 0.12;
/// or ten times when it is a sign, which is known by more than its colour.
const FURTHER_SIGN_SIZE: f32 = 0.01;
/// A known object below this part of the best one's score is a look-alike.
const LOOK_ALIKE_PART: f32 = 0.6;
/// Further objects below this score are doubtful.
const DOUBTFUL_SCORE: f32 = 0.6;
/// Objects are given up after so many frames unseen where another one is in view; the last one never is.
const GIVE_UP_AFTER: u32 = 45;

/// Updates the tracks and reports what was found.
pub(super) fn conclude<'m>(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    (pursuits, further): (List<'m, Pursuit<'m>>, List<'m, Candidate<'m>>),
    tracer: &mut Tracer,
    mut report: Report<'_>,
) {
    let mut best_score = 0.0_f32;
    for (track, pursuit) in state.tracks.iter_mut().zip(pursuits) {
        best_score = best_score.max(pursuit.found.as_ref().map_or(0.0, |found| found.score));
        let outcome = advance(scene, landmark, track, pursuit, tracer, &mut report);
        report.outcomes.push(outcome);
    }
    welcome(scene, landmark, state, (further, best_score), tracer, &mut report);
    forget(state);
    if report.outcomes.is_empty() {
        let outcome = report.missed(landmark, 0, Miss::NoColour { best: None });
        report.outcomes.push(outcome);
    }
}

/// Takes up objects that were not known before, beside those of which the best has that score.
fn welcome(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    (further, mut best_score): (List<'_, Candidate<'_>>, f32),
    tracer: &mut Tracer,
    report: &mut Report<'_>,
) {
    let usual = usual_look(state);
    let least_size = if landmark.shape.is_sign() { FURTHER_SIGN_SIZE } else { FURTHER_SIZE };
    let mut least_score = if state.tracks.is_empty() { FIRST_SCORE } else { FURTHER_SCORE };
    let mut next = further.into_iter().peekable();
    while let Some(candidate) = next.next() {
        let least = least_score.max(FURTHER_PART * best_score.max(usual.score));
        let score = if state.tracks.is_empty() { candidate.score } else { candidate.score_if_further };
        if score < least || candidate.area_px2 < least_size * usual.area_px2 {
            continue;
        }
        // What the picture's border cuts off a sign shows no outline yet, or no more.
        if candidate.cut && landmark.shape.is_board() && !state.tracks.is_empty() {
            continue;
        }
        if state.tracks.len() >= scene.options.max_instances as usize {
            let outcome = report.missed(landmark, state.next_instance, Miss::Skipped);
            report.outcomes.push(outcome);
            break;
        }
        let rival = next.peek().map_or(0.0, |next| next.score);
        let further = !state.tracks.is_empty();
        // A doubtful one beside an object that is known must show the shape as well.
        let veto = if further && candidate.score < DOUBTFUL_SCORE {
            ShapeVeto::Required
        } else {
            scene.options.shape_veto
        };
        let outcome = match describe(landmark, &candidate, (veto, rival), tracer, report) {
            Ok(sighting) => begin(scene, landmark, state, &candidate, sighting, report),
            Err(_) if further => continue,
            Err(miss) => report.missed(landmark, state.next_instance, miss),
        };
        best_score = best_score.max(candidate.score);
        least_score = FURTHER_SCORE;
        report.outcomes.push(outcome);
    }
}

/// What the objects of a landmark that are known look like: a further one must not be much less.
struct UsualLook {
    score: f32,
    area_px2: f32,
}

fn usual_look(state: &LandmarkState) -> UsualLook {
    let known = state.tracks.iter().max_by_key(|track| track.sightings);
    UsualLook {
        score: known.map_or(0.0, |track| track.score),
        area_px2: known.map_or(0.0, |track| track.whole_area_px2),
    }
}

/// Gives up look-alikes, and further objects that were not seen for long. As long as none is in view the best one is kept.
fn forget(state: &mut LandmarkState) {
    let is_in_view = |track: &Track| track.misses < GIVE_UP_AFTER.min(3 + track.sightings);
    let any_in_view = state.tracks.iter().any(is_in_view);
    let counts = |track: &Track| is_in_view(track) || !any_in_view;
    let best = state.tracks.iter().filter(|track| counts(track)).map(|track| track.score).fold(0.0, f32::max);
    let least = if any_in_view { LOOK_ALIKE_PART * best } else { best };
    state.tracks.retain(|track| counts(track) && track.score >= least);
}

fn advance(
    scene: &Scene<'_>,
    landmark: &Landmark,
    track: &mut Track,
    pursuit: Pursuit<'_>,
    tracer: &mut Tracer,
    report: &mut Report<'_>,
) -> LandmarkOutcome {
    let Pursuit { prediction, gate, likeness, found, rival, full_frame, elsewhere } = pursuit;
    let judged = (scene.options.shape_veto, rival);
    let outcome = match found.map(|found| (describe(landmark, &found, judged, tracer, report), found)) {
        Some((Ok(sighting), found)) => {
            let fix = Fix { area_px2: whole_area_px2(&found, &prediction), ..fix(scene, &found) };
            let astray = full_frame && !innovation_gate(&prediction).contains(found.centroid);
            track.follow(&found, fix, if astray { Motion::Anew } else { Motion::Continued });
            LandmarkOutcome {
                innovation_px: Some(prediction.centroid.distance_px(found.centroid)),
                adaptation: Some(adaptation(scene, &found, full_frame)),
                ..report.measured(landmark, track.instance, sighting)
            }
        }
        Some((Err(miss), _)) => {
            track.misses = track.misses.saturating_add(1);
            report.missed(landmark, track.instance, miss)
        }
        None => {
            track.misses = track.misses.saturating_add(1);
            let miss = reason::of_miss(scene, track, &likeness, &prediction, &gate, elsewhere);
            report.missed(landmark, track.instance, miss)
        }
    };
    LandmarkOutcome { prediction: Some(prediction), gate: Some(gate), ..outcome }
}

/// The area of the whole object, of which only a part may be in view.
fn whole_area_px2(found: &Candidate<'_>, prediction: &Prediction) -> f32 {
    if found.cut { found.area_px2.max(prediction.area_px2) } else { found.area_px2 }
}

fn begin(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    found: &Candidate<'_>,
    sighting: Sighting,
    report: &mut Report<'_>,
) -> LandmarkOutcome {
    let predictor = Predictor::new(scene.options.prediction, fix(scene, found));
    let instance = state.begin(predictor, found.light, found.score).instance;
    LandmarkOutcome {
        adaptation: Some(adaptation(scene, found, true)),
        ..report.measured(landmark, instance, sighting)
    }
}

fn fix(scene: &Scene<'_>, found: &Candidate<'_>) -> Fix {
    Fix { captured_at: scene.captured_at, centroid: found.centroid, area_px2: found.area_px2 }
}

/// All that is reported of an object, which has a rival of that score.
///
/// # Errors
/// When its outline is of another shape and `veto` rules that out.
fn describe(
    landmark: &Landmark,
    found: &Candidate<'_>,
    (veto, rival): (ShapeVeto, f32),
    tracer: &mut Tracer,
    report: &mut Report<'_>,
) -> Result<Sighting, Miss> {
    let mut sighting = report.workspace.spare_sighting();
    tracer.trace(&found.object, landmark.shape, &mut sighting);
    if veto.rules_out(sighting.shape_score) {
        let score = sighting.shape_score.unwrap_or(0.0);
        report.workspace.recycle_sighting(sighting);
        return Err(Miss::WrongShape { score });
    }
    Ok(Sighting {
        centroid: found.centroid,
        area_px2: found.area_px2,
        observed: found.observed,
        score: found.score,
        distinctness: (1.0 - rival / found.score.max(1e-3)).clamp(0.0, 1.0),
        ..sighting
    })
}

fn adaptation(scene: &Scene<'_>, found: &Candidate<'_>, full_frame: bool) -> Adaptation {
    Adaptation {
        gain: found.light.gain,
        haze: found.light.haze,
        noise_variance: scene.noise_variance,
        window_px: found.window_px,
        tolerance_scale: found.tolerance_scale,
        full_frame,
    }
}
