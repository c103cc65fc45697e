//! One landmark in one frame: its known objects in their gates, and the whole frame where one of them is missing.

use super::budget::Budget;
use super::state::{LandmarkState, Track};
use super::{Scene, reason, report};
use crate::adaptive::{Candidate, Likeness, Tracer, candidates};
use crate::gate::search_gate;
use crate::geometry::{PointPx, RectPx};
use crate::landmark::Landmark;
use crate::outcome::{Adaptation, Gate, LandmarkOutcome, Miss, Prediction, Sighting};
use crate::predict::{Fix, Predictor};
use crate::probe::{Stage, StageProbe};
use crate::register::ShapeVeto;

/// The first sighting of an object needs this score.
const FIRST_SCORE: f32 = 0.30;
/// One that is followed needs this part of its usual score.
const FOLLOWED_PART: f32 = 0.35;
/// A further object of the same landmark needs this score
const FURTHER_SCORE: f32 = 0.5;
/// and this part of the best one's score.
const FURTHER_PART: f32 = 0.75;
/// and this part of the area of the one that is known best.
const FURTHER_SIZE: f32 = 0.12;
/// A known object below this part of the best one's score is a look-alike.
const LOOK_ALIKE_PART: f32 = 0.6;
/// Further objects below this score are doubtful.
const DOUBTFUL_SCORE: f32 = 0.6;
/// The whole frame is searched for further objects every so many frames.
const SEARCH_EVERY: u32 = 8;
/// Seeds looked at closely in a gate and in the whole frame.
const SEEDS: (usize, usize) = (4, 12);
/// Further objects are given up after so many frames unseen; the last one never is.
const GIVE_UP_AFTER: u32 = 45;

/// One followed object in this frame.
struct Pursuit {
    prediction: Prediction,
    gate: Gate,
    found: Option<Candidate>,
    /// The best score of what was not taken for it.
    rival: f32,
    full_frame: bool,
    /// Where the nearest thing is that looks like it and cannot be it.
    elsewhere: Option<PointPx>,
}

/// The outcome of a landmark that is not looked for in this frame.
pub(super) fn skipped(landmark: &Landmark, instance: u32) -> LandmarkOutcome {
    report::missed(landmark, instance, Miss::Skipped)
}

/// Registers one landmark and updates what is known of it.
pub(super) fn landmark<P: StageProbe>(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    budget: &mut Budget,
    tracer: &mut Tracer,
    probe: &mut P,
) -> Vec<LandmarkOutcome> {
    probe.begin(Stage::Mask);
    let mut pursuits: Vec<Pursuit> = Vec::with_capacity(state.tracks.len());
    for track in &state.tracks {
        let pursuit = in_gate(scene, landmark, track, &pursuits, budget);
        pursuits.push(pursuit);
    }
    state.frames_since_search = state.frames_since_search.saturating_add(1);
    let lost = pursuits.iter().any(|pursuit| pursuit.found.is_none());
    let wanted = pursuits.is_empty() || lost || state.frames_since_search >= SEARCH_EVERY;
    let further = if wanted { anywhere(scene, landmark, state, budget) } else { Some(Vec::new()) };
    probe.end(Stage::Mask);
    let Some(mut further) = further else {
        if pursuits.is_empty() {
            return vec![skipped(landmark, 0)];
        }
        return staged(probe, || conclude(scene, landmark, state, pursuits, Vec::new(), tracer));
    };
    for (track, pursuit) in state.tracks.iter().zip(&mut pursuits) {
        reacquire(track, pursuit, &mut further);
    }
    staged(probe, || conclude(scene, landmark, state, pursuits, further, tracer))
}

fn staged<P: StageProbe, T>(probe: &mut P, work: impl FnOnce() -> T) -> T {
    probe.begin(Stage::Shape);
    let result = work();
    probe.end(Stage::Shape);
    result
}

/// Looks for a followed object where it should be.
fn in_gate(
    scene: &Scene<'_>,
    landmark: &Landmark,
    track: &Track,
    others: &[Pursuit],
    budget: &mut Budget,
) -> Pursuit {
    let prediction = track.predictor.predict(scene.captured_at);
    let gate = search_gate(&prediction);
    let mut pursuit =
        Pursuit { prediction, gate, found: None, rival: 0.0, full_frame: false, elsewhere: None };
    let Some(region) = gate.bounds(scene.frame.size()) else { return pursuit };
    if budget.spend(u64::from(region.width) * u64::from(region.height)).is_none() {
        return pursuit;
    }
    let likeness = Likeness::followed(landmark, track.gain, scene.noise_variance);
    let mut seen = candidates(&scene.search(landmark, region, &likeness, track.gain, SEEDS.0));
    let taken = |candidate: &Candidate| {
        others.iter().filter_map(|other| other.found.as_ref()).any(|found| found.covers(candidate.centroid))
    };
    let merit = |candidate: &Candidate| candidate.score * consistency(&prediction, candidate);
    seen.retain(|candidate| gate.contains(candidate.centroid) && !taken(candidate));
    seen.sort_by(|a, b| merit(b).total_cmp(&merit(a)));
    pursuit.rival = seen.get(1).map_or(0.0, merit);
    pursuit.found = seen.into_iter().next().filter(|best| merit(best) >= FOLLOWED_PART * track.score);
    pursuit
}

/// How well a candidate continues what was known of the object: its place and its size, 0..1.
fn consistency(prediction: &Prediction, candidate: &Candidate) -> f32 {
    let [xx, _, yy] = prediction.covariance_px2;
    let extent = 0.5 * prediction.area_px2.sqrt();
    let off = prediction.centroid.distance_px(candidate.centroid) / (extent + (xx + yy).sqrt());
    let size = (candidate.area_px2 / prediction.area_px2.max(1.0)).ln();
    // An object that enters or leaves the picture shows less of itself.
    let size = if candidate.cut { size.max(0.0) } else { size };
    (-0.5 * (off / 1.5).powi(2) - 0.5 * (size / 0.5).powi(2)).exp()
}

/// Objects that look like the landmark in the whole frame; `None` when the budget does not allow the search.
fn anywhere(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    budget: &mut Budget,
) -> Option<Vec<Candidate>> {
    let region = RectPx::whole(scene.frame.size());
    budget.spend(u64::from(region.width) * u64::from(region.height))?;
    state.frames_since_search = 0;
    let gain = state.tracks.first().map_or(1.0, |track| track.gain);
    let likeness = Likeness::anywhere(landmark, gain, scene.noise_variance);
    Some(candidates(&scene.search(landmark, region, &likeness, gain, SEEDS.1)))
}

/// Takes up a lost object where the whole frame shows one that can be it.
fn reacquire(track: &Track, pursuit: &mut Pursuit, further: &mut Vec<Candidate>) {
    if let Some(found) = &pursuit.found {
        further.retain(|candidate| !found.covers(candidate.centroid) && !candidate.covers(found.centroid));
        return;
    }
    let [xx, _, yy] = pursuit.prediction.covariance_px2;
    let lost = (track.misses + 1) as f32;
    let reach_px = 2.0 * pursuit.prediction.area_px2.sqrt() + 4.0 * (xx + yy).sqrt() + 12.0 * lost;
    let possible = |candidate: &Candidate| {
        let off_px = pursuit.prediction.centroid.distance_px(candidate.centroid);
        let size = (candidate.area_px2 / pursuit.prediction.area_px2.max(1.0)).ln();
        // What comes out from behind something, or into the picture, shows less of itself.
        let partly = candidate.cut || track.misses > 1;
        let smallest = if partly { -2.5 } else { -0.6 };
        (smallest..0.6 + 0.02 * lost).contains(&size)
            && off_px <= reach_px
            && candidate.score >= 0.6 * track.score
    };
    if let Some(at) = further.iter().position(possible) {
        pursuit.found = Some(further.remove(at));
        pursuit.full_frame = true;
        pursuit.rival = further.first().map_or(0.0, |next| next.score);
    } else {
        let alike = further.iter().filter(|candidate| candidate.score >= 0.6 * track.score);
        let off_px = |candidate: &&Candidate| pursuit.prediction.centroid.distance_px(candidate.centroid);
        let nearest = alike.min_by(|a, b| off_px(a).total_cmp(&off_px(b)));
        pursuit.elsewhere = nearest.map(|candidate| candidate.centroid);
    }
}

/// Updates the tracks and says what was found.
fn conclude(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    pursuits: Vec<Pursuit>,
    further: Vec<Candidate>,
    tracer: &mut Tracer,
) -> Vec<LandmarkOutcome> {
    let mut outcomes = Vec::new();
    let mut best_score = 0.0_f32;
    for (track, pursuit) in state.tracks.iter_mut().zip(pursuits) {
        best_score = best_score.max(pursuit.found.as_ref().map_or(0.0, |found| found.score));
        outcomes.push(advance(scene, landmark, track, pursuit, tracer));
    }
    welcome(scene, landmark, state, further, best_score, tracer, &mut outcomes);
    forget(state);
    if outcomes.is_empty() {
        outcomes.push(report::missed(landmark, 0, Miss::NoColour { best: None }));
    }
    outcomes
}

/// Takes up objects that were not known before.
fn welcome(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    further: Vec<Candidate>,
    mut best_score: f32,
    tracer: &mut Tracer,
    outcomes: &mut Vec<LandmarkOutcome>,
) {
    let usual = usual_look(state);
    let mut least_score = if state.tracks.is_empty() { FIRST_SCORE } else { FURTHER_SCORE };
    let mut next = further.into_iter().peekable();
    while let Some(candidate) = next.next() {
        let least = least_score.max(FURTHER_PART * best_score.max(usual.score));
        if candidate.score < least || candidate.area_px2 < FURTHER_SIZE * usual.area_px2 {
            continue;
        }
        if state.tracks.len() >= scene.options.max_instances as usize {
            outcomes.push(skipped(landmark, state.next_instance));
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
        let outcome = match describe(landmark, &candidate, veto, rival, tracer) {
            Ok(sighting) => begin(scene, landmark, state, &candidate, sighting),
            Err(_) if further => continue,
            Err(miss) => report::missed(landmark, state.next_instance, miss),
        };
        best_score = best_score.max(candidate.score);
        least_score = FURTHER_SCORE;
        outcomes.push(outcome);
    }
}

/// What the objects of a landmark that are known look like: a further one must not be much less.
struct UsualLook {
    score: f32,
    area_px2: f32,
}

fn usual_look(state: &LandmarkState) -> UsualLook {
    let known = state.tracks.iter().max_by_key(|track| track.sightings);
    let area_px2 = |track: &Track| track.predictor.fixes.first().map_or(0.0, |fix| fix.area_px2);
    UsualLook { score: known.map_or(0.0, |track| track.score), area_px2: known.map_or(0.0, area_px2) }
}

/// Drops objects that stayed unseen, and look-alikes beside something that looks far more like the landmark. The one
/// that looks most like it is never dropped.
fn forget(state: &mut LandmarkState) {
    let best = state.tracks.iter().map(|track| track.score).fold(0.0, f32::max);
    state.tracks.retain(|track| {
        let seen = track.misses < GIVE_UP_AFTER.min(3 + track.sightings);
        track.score >= best || (seen && track.score >= LOOK_ALIKE_PART * best)
    });
}

fn advance(
    scene: &Scene<'_>,
    landmark: &Landmark,
    track: &mut Track,
    pursuit: Pursuit,
    tracer: &mut Tracer,
) -> LandmarkOutcome {
    let Pursuit { prediction, gate, found, rival, full_frame, elsewhere } = pursuit;
    let veto = scene.options.shape_veto;
    let outcome = match found.map(|found| (describe(landmark, &found, veto, rival, tracer), found)) {
        Some((Ok(sighting), found)) => {
            track.follow(&found, fix(scene, &found));
            LandmarkOutcome {
                innovation_px: Some(prediction.centroid.distance_px(found.centroid)),
                adaptation: Some(adaptation(scene, &found, full_frame)),
                ..report::measured(landmark, track.instance, sighting)
            }
        }
        Some((Err(miss), _)) => {
            track.misses = track.misses.saturating_add(1);
            report::missed(landmark, track.instance, miss)
        }
        None => {
            track.misses = track.misses.saturating_add(1);
            let likeness = Likeness::followed(landmark, track.gain, scene.noise_variance);
            let miss = reason::of_miss(scene, track, &likeness, &prediction, &gate, elsewhere);
            report::missed(landmark, track.instance, miss)
        }
    };
    LandmarkOutcome { prediction: Some(prediction), gate: Some(gate), ..outcome }
}

fn begin(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    found: &Candidate,
    sighting: Sighting,
) -> LandmarkOutcome {
    let predictor = Predictor::new(scene.options.prediction, fix(scene, found));
    let instance = state.begin(predictor, found.gain, found.score).instance;
    LandmarkOutcome {
        adaptation: Some(adaptation(scene, found, true)),
        ..report::measured(landmark, instance, sighting)
    }
}

fn fix(scene: &Scene<'_>, found: &Candidate) -> Fix {
    Fix { captured_at: scene.captured_at, centroid: found.centroid, area_px2: found.area_px2 }
}

/// All that is reported of an object.
///
/// # Errors
/// When its outline is of another shape and `veto` rules that out.
fn describe(
    landmark: &Landmark,
    found: &Candidate,
    veto: ShapeVeto,
    rival: f32,
    tracer: &mut Tracer,
) -> Result<Sighting, Miss> {
    let traced = tracer.trace(&found.object, landmark.shape);
    if veto.rules_out(traced.shape_score) {
        return Err(Miss::WrongShape { score: traced.shape_score.unwrap_or(0.0) });
    }
    Ok(Sighting {
        centroid: found.centroid,
        area_px2: found.area_px2,
        mask_area_2x: traced.mask_area_2x,
        outline: traced.outline,
        segments: traced.segments,
        shape_score: traced.shape_score,
        observed: found.observed,
        score: found.score,
        distinctness: (1.0 - rival / found.score.max(1e-3)).clamp(0.0, 1.0),
    })
}

fn adaptation(scene: &Scene<'_>, found: &Candidate, full_frame: bool) -> Adaptation {
    Adaptation {
        gain: found.gain,
        noise_variance: scene.noise_variance,
        window_px: found.window_px,
        tolerance_scale: found.tolerance_scale,
        full_frame,
    }
}
