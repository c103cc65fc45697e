//! One landmark in one frame: its known objects in their gates, and the whole frame where one of them is missing.

use super::budget::Budget;
use super::conclude::conclude;
use super::report::Report;
use super::state::{LandmarkState, Track};
use super::{Scene, Tools};
use crate::adaptive::memory::{List, Memory, sorted};
use crate::adaptive::{Candidate, Finder, Likeness};
use crate::gate::search_gate;
use crate::geometry::{PointPx, RectPx};
use crate::landmark::Landmark;
use crate::outcome::{Gate, Miss, Prediction};
use crate::probe::{Stage, StageProbe};

/// One that is followed needs this part of its usual score.
const FOLLOWED_PART: f32 = 0.35;
/// The whole frame is searched for further objects every so many frames.
const SEARCH_EVERY: u32 = 8;
/// An object cut by the picture's border is gone when it shows less than this part of its area.
const SLIVER: f32 = 0.12;
/// Of an object seen so often the size is known,
const KNOWN_AFTER: u32 = 3;
/// and less than this part of it is not all of it.
const COVERED_PART: f32 = 0.75;
/// A part of an object lies within so many of its radii: corners reach further than the disc of the same area.
const WITHIN: f32 = 1.25;
/// Less than this part of an object, so near its middle in sides of a square of its area, is a piece of it.
const PIECE: f32 = 0.35;
const ON_IT: f32 = 0.72;
/// Seeds looked at closely in a gate and in the whole frame,
const SEEDS: (usize, usize) = (4, 12);
/// and for a lettered sign, of which lettering leaves several, among red kerbs and cars or green bushes.
const LETTERED_SIGN_SEEDS: (usize, usize) = (8, 24);

/// Whether more than one object was ever seen that looks like the landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Company {
    Alone,
    Others,
}

/// One followed object in this frame.
pub(super) struct Pursuit<'m> {
    pub(super) prediction: Prediction,
    pub(super) gate: Gate,
    pub(super) likeness: Likeness<'m>,
    pub(super) found: Option<Candidate<'m>>,
    /// The best score of what was not taken for it.
    pub(super) rival: f32,
    pub(super) full_frame: bool,
    /// Where the nearest thing is that looks like it and cannot be it.
    pub(super) elsewhere: Option<PointPx>,
}

fn seeds(landmark: &Landmark, likeness: &Likeness<'_>) -> (usize, usize) {
    let several = landmark.shape.is_round() || landmark.shape.is_board();
    if several && likeness.face().is_some() { LETTERED_SIGN_SEEDS } else { SEEDS }
}

/// Registers one landmark and updates what is known of it.
pub(super) fn landmark<P: StageProbe>(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    budget: &mut Budget,
    tools: &mut Tools,
    mut report: Report<'_>,
    probe: &mut P,
) {
    let Tools { finder, tracer, memory } = tools;
    memory.reset();
    let memory = &*memory;
    probe.begin(Stage::Mask);
    let mut pursuits: List<'_, Pursuit<'_>> = List::with_capacity_in(state.tracks.len(), memory);
    for track in &state.tracks {
        let pursuit = in_gate(scene, landmark, track, &pursuits, budget, finder, memory);
        pursuits.push(pursuit);
    }
    state.frames_since_search = state.frames_since_search.saturating_add(1);
    let lost = pursuits.iter().any(|pursuit| pursuit.found.is_none());
    let room = pursuits.len() < scene.options.max_instances as usize;
    let wanted = pursuits.is_empty() || lost || (room && state.frames_since_search >= SEARCH_EVERY);
    let further = wanted.then(|| anywhere(scene, landmark, state, budget, finder, memory)).flatten();
    probe.end(Stage::Mask);
    let further = match further {
        Some(further) => shared_out(landmark, state, &mut pursuits, further),
        None if pursuits.is_empty() => {
            let outcome = report.missed(landmark, 0, Miss::Skipped);
            report.outcomes.push(outcome);
            return;
        }
        None => List::new_in(memory),
    };
    staged(probe, || conclude(scene, landmark, state, (pursuits, further), tracer, report));
}

/// What the whole frame shows beside the objects that are known; of those, the lost ones are taken up.
fn shared_out<'m>(
    landmark: &Landmark,
    state: &LandmarkState,
    pursuits: &mut [Pursuit<'m>],
    mut further: List<'m, Candidate<'m>>,
) -> List<'m, Candidate<'m>> {
    for found in pursuits.iter().filter_map(|pursuit| pursuit.found.as_ref()) {
        further.retain(|candidate| !found.covers(candidate.centroid) && !candidate.covers(found.centroid));
    }
    let seen = pursuits.iter().filter(|pursuit| landmark.shape.is_board() && pursuit.found.is_some());
    for Pursuit { prediction, .. } in seen {
        further.retain(|candidate| !lies_on(prediction, candidate));
    }
    let company = if state.next_instance > 1 { Company::Others } else { Company::Alone };
    for (track, pursuit) in state.tracks.iter().zip(pursuits) {
        reacquire(track, company, pursuit, &mut further);
    }
    further
}

fn staged<P: StageProbe, T>(probe: &mut P, work: impl FnOnce() -> T) -> T {
    probe.begin(Stage::Shape);
    let result = work();
    probe.end(Stage::Shape);
    result
}

/// Looks for a followed object where it should be.
fn in_gate<'m>(
    scene: &Scene<'_>,
    landmark: &Landmark,
    track: &Track,
    others: &[Pursuit<'m>],
    budget: &mut Budget,
    finder: &mut Finder,
    memory: &'m Memory,
) -> Pursuit<'m> {
    let prediction = track.predictor.predict(scene.captured_at);
    let gate = search_gate(&prediction);
    let likeness = Likeness::followed(memory, landmark, track.light(), scene.noise_variance);
    let mut pursuit =
        Pursuit { prediction, gate, likeness, found: None, rival: 0.0, full_frame: false, elsewhere: None };
    let Some(region) = gate.bounds(scene.frame.size()) else { return pursuit };
    if budget.spend(u64::from(region.width) * u64::from(region.height)).is_none() {
        return pursuit;
    }
    let limit = seeds(landmark, &likeness).0;
    let mut seen = finder.candidates(&scene.search(landmark, region, likeness, track.light(), limit), memory);
    let taken = |candidate: &Candidate<'_>| {
        others.iter().filter_map(|other| other.found.as_ref()).any(|found| found.covers(candidate.centroid))
    };
    let part = |candidate: &&mut Candidate<'_>| {
        may_be_covered(track, candidate) && is_within(&prediction, candidate)
    };
    seen.iter_mut().filter(part).for_each(Candidate::take_for_a_part);
    let merit = |candidate: &Candidate<'_>| candidate.score * consistency(&prediction, candidate);
    // A last sliver at the picture's border is not the object any more.
    let gone =
        |candidate: &Candidate<'_>| candidate.cut && candidate.area_px2 < SLIVER * track.whole_area_px2;
    seen.retain(|candidate| gate.contains(candidate.centroid) && !taken(candidate) && !gone(candidate));
    let mut best_first = sorted(seen, |a, b| merit(b).total_cmp(&merit(a)));
    let best = best_first.next();
    pursuit.rival = best_first.next().map_or(0.0, |next| merit(&next));
    pursuit.found = best.filter(|best| merit(best) >= FOLLOWED_PART * track.score);
    pursuit
}

/// Whether something may cover a part of the object, so that a candidate is what it leaves in view.
fn may_be_covered(track: &Track, candidate: &Candidate<'_>) -> bool {
    track.sightings >= KNOWN_AFTER
        && candidate.area_px2 < COVERED_PART * track.whole_area_px2
        && candidate.score_if_covered > candidate.score
}

/// Whether a candidate lies where the object should be: what something leaves of it in view does not reach beyond it.
fn is_within(prediction: &Prediction, candidate: &Candidate<'_>) -> bool {
    let [xx, _, yy] = prediction.covariance_px2;
    let radius_px = |area_px2: f32| (area_px2 / std::f32::consts::PI).sqrt();
    let reach_px = prediction.centroid.distance_px(candidate.centroid) + radius_px(candidate.area_px2);
    reach_px <= WITHIN * radius_px(prediction.area_px2) + (xx + yy).sqrt()
}

/// Whether a candidate is but a piece of the object that is predicted.
fn lies_on(prediction: &Prediction, candidate: &Candidate<'_>) -> bool {
    candidate.area_px2 < PIECE * prediction.area_px2
        && prediction.centroid.distance_px(candidate.centroid) < ON_IT * prediction.area_px2.sqrt()
}

/// How well a candidate continues what was known of the object: its place and its size, 0..1.
fn consistency(prediction: &Prediction, candidate: &Candidate<'_>) -> f32 {
    let [xx, _, yy] = prediction.covariance_px2;
    let extent = 0.5 * prediction.area_px2.sqrt();
    let off = prediction.centroid.distance_px(candidate.centroid) / (extent + (xx + yy).sqrt());
    let size = (candidate.area_px2 / prediction.area_px2.max(1.0)).ln();
    // An object that enters or leaves the picture shows less of itself.
    let size = if candidate.cut { size.max(0.0) } else { size };
    (-0.5 * (off / 1.5).powi(2) - 0.5 * (size / 0.5).powi(2)).exp()
}

/// Objects that look like the landmark in the whole frame; `None` when the budget does not allow the search.
fn anywhere<'m>(
    scene: &Scene<'_>,
    landmark: &Landmark,
    state: &mut LandmarkState,
    budget: &mut Budget,
    finder: &mut Finder,
    memory: &'m Memory,
) -> Option<List<'m, Candidate<'m>>> {
    let region = RectPx::whole(scene.frame.size());
    budget.spend(u64::from(region.width) * u64::from(region.height))?;
    state.frames_since_search = 0;
    let light = state.light();
    let likeness = Likeness::anywhere(memory, landmark, light, scene.noise_variance);
    let limit = seeds(landmark, &likeness).1;
    Some(finder.candidates(&scene.search(landmark, region, likeness, light, limit), memory))
}

/// Takes up a lost object where the whole frame shows one that can be it: far away only where no other one was ever seen
/// that could be mistaken for it.
fn reacquire<'m>(
    track: &Track,
    company: Company,
    pursuit: &mut Pursuit<'m>,
    further: &mut List<'m, Candidate<'m>>,
) {
    if pursuit.found.is_some() {
        return;
    }
    let size_px = pursuit.prediction.area_px2.sqrt();
    let [xx, _, yy] = pursuit.prediction.covariance_px2;
    let sigma_px = (xx + yy).sqrt();
    let lost = (track.misses + 1) as f32;
    let reach_px = match company {
        Company::Alone => 2.0 * size_px + 4.0 * sigma_px + 12.0 * lost,
        Company::Others => size_px + sigma_px.min(size_px),
    };
    let off_px = |candidate: &Candidate<'_>| pursuit.prediction.centroid.distance_px(candidate.centroid);
    let prediction = pursuit.prediction;
    let is_part = |candidate: &Candidate<'_>| {
        may_be_covered(track, candidate) && (company == Company::Alone || is_within(&prediction, candidate))
    };
    let score = |candidate: &Candidate<'_>| {
        if is_part(candidate) { candidate.score_if_covered } else { candidate.score }
    };
    let possible = |candidate: &Candidate<'_>| {
        let size = (candidate.area_px2 / pursuit.prediction.area_px2.max(1.0)).ln();
        // What comes out from behind something, or into the picture, shows less of itself.
        let partly = candidate.cut || track.misses > 1;
        let smallest = if partly { -2.5 } else { -0.6 };
        (smallest..0.6 + 0.02 * lost).contains(&size)
            && off_px(candidate) <= reach_px
            && score(candidate) >= 0.6 * track.score
            && !(partly && candidate.area_px2 < SLIVER * track.whole_area_px2)
    };
    if let Some(at) = further.iter().position(possible) {
        let mut found = further.remove(at);
        if is_part(&found) {
            found.take_for_a_part();
        }
        pursuit.found = Some(found);
        pursuit.full_frame = true;
        pursuit.rival = further.first().map_or(0.0, |next| next.score);
    } else {
        let alike = further.iter().filter(|candidate| candidate.score >= 0.6 * track.score);
        let nearest = alike.min_by(|a, b| off_px(a).total_cmp(&off_px(b)));
        pursuit.elsewhere = nearest.map(|candidate| candidate.centroid);
    }
}
