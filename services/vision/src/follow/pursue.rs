//! One landmark in one frame: its known objects in their gates, and the whole frame where one of them is missing.

use super::budget::Budget;
use super::state::{LandmarkState, Track};
use super::{Scene, report};
use crate::adaptive::{Candidate, Likeness, Search, candidates};
use crate::gate::search_gate;
use crate::geometry::RectPx;
use crate::landmark::Landmark;
use crate::outcome::{Adaptation, Gate, LandmarkOutcome, Miss, Prediction, Sighting};
use crate::predict::{Fix, Predictor};
use crate::probe::{Stage, StageProbe};

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
/// The whole frame is searched for further objects every so many frames.
const SEARCH_EVERY: u32 = 8;
/// Seeds looked at closely in a gate and in the whole frame.
const SEEDS: (usize, usize) = (4, 12);
/// How fast gain and score are followed.
const FOLLOW_RATE: f32 = 0.2;
/// Further objects are given up after so many frames unseen; the last one never is.
const GIVE_UP_AFTER: u32 = 45;

/// One followed object in this frame.
struct Pursuit {
    prediction: Prediction,
    gate: Gate,
    found: Option<Candidate>,
    full_frame: bool,
}

/// The outcome of a landmark that is not looked for in this frame.
pub(super) fn skipped(landmark: &Landmark, state: &LandmarkState, scene: &Scene<'_>) -> Vec<LandmarkOutcome> {
    let outcome = |instance: u32, prediction: Option<Prediction>| LandmarkOutcome {
        prediction,
        ..report::missed(landmark, instance, Miss::Skipped)
    };
    if state.tracks.is_empty() {
        return vec![outcome(0, None)];
    }
    let of_track = |track: &Track| outcome(track.instance, Some(track.predictor.predict(scene.captured_at)));
    state.tracks.iter().map(of_track).collect()
}

/// Registers one landmark and updates what is known of it.
pub(super) fn landmark<P: StageProbe>(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    budget: &mut Budget,
    probe: &mut P,
) -> Vec<LandmarkOutcome> {
    probe.begin(Stage::Statistics);
    let mut pursuits: Vec<Pursuit> = Vec::with_capacity(state.tracks.len());
    for track in &state.tracks {
        let pursuit = in_gate(scene, landmark, track, &pursuits, budget);
        pursuits.push(pursuit);
    }
    state.frames_since_search += 1;
    let lost = pursuits.iter().any(|pursuit| pursuit.found.is_none());
    let mut further = Vec::new();
    if pursuits.is_empty() || lost || state.frames_since_search >= SEARCH_EVERY {
        state.frames_since_search = 0;
        further = anywhere(scene, landmark, state, budget);
        for (track, pursuit) in state.tracks.iter().zip(&mut pursuits) {
            reacquire(track, pursuit, &mut further);
        }
    }
    probe.end(Stage::Statistics);
    conclude(scene, landmark, state, pursuits, further)
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
    let mut pursuit = Pursuit { prediction, gate, found: None, full_frame: false };
    let Some(region) = gate.bounds(scene.frame.size()) else { return pursuit };
    budget.spend(u64::from(region.width) * u64::from(region.height));
    let likeness = Likeness::followed(landmark, track.gain, scene.noise_variance);
    let search = Search {
        frame: scene.frame,
        region,
        landmark,
        likeness: &likeness,
        gain: track.gain,
        noise_variance: scene.noise_variance,
        limit: SEEDS.0,
    };
    let taken = |candidate: &Candidate| {
        others.iter().filter_map(|other| other.found.as_ref()).any(|found| found.covers(candidate.centroid))
    };
    let believed = |candidate: &Candidate| {
        gate.contains(candidate.centroid)
            && candidate.score * consistency(&prediction, candidate) >= FOLLOWED_PART * track.score
            && !taken(candidate)
    };
    let merit = |candidate: &Candidate| candidate.score * consistency(&prediction, candidate);
    pursuit.found =
        candidates(&search).into_iter().filter(believed).max_by(|a, b| merit(a).total_cmp(&merit(b)));
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

/// Objects that look like the landmark in the whole frame.
fn anywhere(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &LandmarkState,
    budget: &mut Budget,
) -> Vec<Candidate> {
    let region = RectPx::whole(scene.frame.size());
    budget.spend(u64::from(region.width) * u64::from(region.height));
    let gain = state.tracks.first().map_or(1.0, |track| track.gain);
    let likeness = Likeness::anywhere(landmark, gain, scene.noise_variance);
    candidates(&Search {
        frame: scene.frame,
        region,
        landmark,
        likeness: &likeness,
        gain,
        noise_variance: scene.noise_variance,
        limit: SEEDS.1,
    })
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
        pursuit.found = Some(further.swap_remove(at));
        pursuit.full_frame = true;
    }
}

/// Updates the tracks and says what was found.
fn conclude(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    pursuits: Vec<Pursuit>,
    further: Vec<Candidate>,
) -> Vec<LandmarkOutcome> {
    let mut outcomes = Vec::new();
    let mut best_score = 0.0_f32;
    for (track, pursuit) in state.tracks.iter_mut().zip(pursuits) {
        best_score = best_score.max(pursuit.found.as_ref().map_or(0.0, |found| found.score));
        outcomes.push(advance(scene, landmark, track, pursuit));
    }
    let usual = usual_look(state);
    let mut least_score = if state.tracks.is_empty() { FIRST_SCORE } else { FURTHER_SCORE };
    for candidate in further {
        let full = state.tracks.len() >= scene.options.max_instances as usize;
        let least = least_score.max(FURTHER_PART * best_score.max(usual.score));
        if candidate.score < least || candidate.area_px2 < FURTHER_SIZE * usual.area_px2 || full {
            continue;
        }
        best_score = best_score.max(candidate.score);
        least_score = FURTHER_SCORE;
        outcomes.push(begin(scene, landmark, state, &candidate));
    }
    forget(state);
    if outcomes.is_empty() {
        outcomes.push(report::missed(landmark, 0, Miss::NoColour { best: None }));
    }
    outcomes
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

fn advance(scene: &Scene<'_>, landmark: &Landmark, track: &mut Track, pursuit: Pursuit) -> LandmarkOutcome {
    let Pursuit { prediction, gate, found, full_frame } = pursuit;
    let known = |outcome: LandmarkOutcome| LandmarkOutcome {
        prediction: Some(prediction),
        gate: Some(gate),
        ..outcome
    };
    let Some(found) = found else {
        track.misses += 1;
        let reason = if gate.bounds(scene.frame.size()).is_none() {
            Miss::OutsideFrame
        } else {
            Miss::NoColour { best: None }
        };
        return known(report::missed(landmark, track.instance, reason));
    };
    track.misses = 0;
    track.sightings += 1;
    track.gain += FOLLOW_RATE * (found.gain - track.gain);
    track.score += FOLLOW_RATE * (found.score - track.score);
    track.predictor.update(fix(scene, &found));
    LandmarkOutcome {
        innovation_px: Some(prediction.centroid.distance_px(found.centroid)),
        ..known(measured(scene, landmark, track.instance, &found, full_frame))
    }
}

fn begin(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    found: &Candidate,
) -> LandmarkOutcome {
    let predictor = Predictor::new(scene.options.prediction, fix(scene, found));
    let instance = state.begin(predictor, found.gain, found.score).instance;
    measured(scene, landmark, instance, found, true)
}

fn fix(scene: &Scene<'_>, found: &Candidate) -> Fix {
    Fix { captured_at: scene.captured_at, centroid: found.centroid, area_px2: found.area_px2 }
}

fn measured(
    scene: &Scene<'_>,
    landmark: &Landmark,
    instance: u32,
    found: &Candidate,
    full_frame: bool,
) -> LandmarkOutcome {
    let sighting = Sighting {
        centroid: found.centroid,
        area_px2: found.area_px2,
        mask_area_2x: 4.0 * found.area_px2,
        outline: found.object.hull(),
        observed: found.observed,
        score: found.score,
        distinctness: 1.0,
        ..Sighting::default()
    };
    let adaptation = Adaptation {
        gain: found.gain,
        noise_variance: scene.noise_variance,
        window_px: found.window_px,
        tolerance_scale: 1.0,
        full_frame,
    };
    LandmarkOutcome { adaptation: Some(adaptation), ..report::measured(landmark, instance, sighting) }
}
