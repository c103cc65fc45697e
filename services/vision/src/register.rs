//! Registration of one landmark in one frame: the 14 steps of thesis 4.0.3, with fixed statistics and tolerances.

use crate::bitmask::BitMask;
use crate::components::{Component, Components};
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::hough::Hough;
use crate::landmark::Landmark;
use crate::mask::Masker;
use crate::measure::{self, Evidence};
use crate::outcome::{Miss, Prediction, Sighting};
use crate::outline::Outline;
use crate::probe::{Stage, StageProbe};
use crate::score;
use crate::shape;

/// Components looked at closely, the largest first: the bound on the work that one landmark can cause.
const MOST_CANDIDATES: usize = 64;

/// What is asked for beside the landmark itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Request<'a> {
    /// The part of the frame that is searched; `None` for all of it.
    pub region: Option<RectPx>,
    /// Whether an outline of another shape counts as a miss.
    pub shape_veto: ShapeVeto,
    /// Where and how large the object is expected; decides between candidates, excludes none.
    pub prediction: Option<&'a Prediction>,
}

/// Whether an outline that does not fit the landmark's shape class rules a candidate out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ShapeVeto {
    /// It only lowers the score.
    #[default]
    Off,
    /// It is a miss, where the object is large enough to show a shape.
    Required,
}

impl ShapeVeto {
    /// Whether a candidate of this fit is ruled out.
    #[must_use]
    pub fn rules_out(self, shape_score: Option<f32>) -> bool {
        self == Self::Required && shape_score.is_some_and(|fit| fit < shape::SMALLEST_FIT)
    }
}

/// Memory that registration keeps from frame to frame.
#[derive(Default)]
pub struct Workspace {
    masker: Masker,
    mask: BitMask,
    components: Components,
    candidates: Vec<Component>,
    outline: Outline,
    hough: Hough,
    /// Lists and sightings that came back, to be filled again.
    spare_lists: Vec<Vec<Sighting>>,
    spare: Vec<Sighting>,
}

impl Workspace {
    /// One that computes masks with `masker`.
    #[must_use]
    pub fn with_masker(masker: Masker) -> Self {
        Self { masker, ..Self::default() }
    }

    /// One that came back, or an empty one, to be written anew.
    pub(crate) fn spare_sighting(&mut self) -> Sighting {
        self.spare.pop().unwrap_or_default()
    }

    /// As [`recycle`](Self::recycle), one of them.
    pub(crate) fn recycle_sighting(&mut self, sighting: Sighting) {
        if self.spare.len() < MOST_CANDIDATES {
            self.spare.push(sighting);
        }
    }

    /// Takes back what [`register`] gave, so that the next one need not ask for memory.
    pub fn recycle(&mut self, mut sightings: Vec<Sighting>) {
        sightings.drain(..).for_each(|sighting| self.recycle_sighting(sighting));
        if self.spare_lists.len() < MOST_CANDIDATES {
            self.spare_lists.push(sightings);
        }
    }

    /// The mask of the last registration, on the doubled grid.
    #[must_use]
    pub fn mask(&self) -> &BitMask {
        &self.mask
    }
}

/// Finds all plausible instances of `landmark` in `frame`, best first; never an empty list.
///
/// # Errors
/// The reason why there is none: [`Miss::OutsideFrame`] when the region lies outside the frame, [`Miss::TooSmall`] when
/// no window fits into it, [`Miss::NoColour`] when no window matches, [`Miss::WrongShape`] when the veto was asked for
/// and struck out every candidate.
pub fn register<P: StageProbe>(
    frame: &Frame,
    landmark: &Landmark,
    request: &Request<'_>,
    workspace: &mut Workspace,
    probe: &mut P,
) -> Result<Vec<Sighting>, Miss> {
    register_by(None, frame, landmark, request, workspace, probe)
}

/// As [`register`] for each of `landmarks` in turn; passes over the frame are shared by those that have the same window.
/// `each` is given the number of the landmark and what was found; what it is given last, it may
/// [give back](Workspace::recycle).
pub fn register_all<'l, P: StageProbe>(
    frame: &Frame,
    landmarks: impl Iterator<Item = &'l Landmark> + Clone,
    request: &Request<'_>,
    workspace: &mut Workspace,
    probe: &mut P,
    mut each: impl FnMut(usize, Result<Vec<Sighting>, Miss>, &mut Workspace),
) {
    let sought = landmarks.clone().enumerate().filter_map(|(number, landmark)| {
        let grid = grid(frame, landmark, request).ok()?;
        Some((number, grid, landmark))
    });
    probe.begin(Stage::Statistics);
    workspace.masker.share(frame, &sought);
    probe.end(Stage::Statistics);
    for (number, landmark) in landmarks.enumerate() {
        let found = register_by(Some(number), frame, landmark, request, workspace, probe);
        each(number, found, workspace);
    }
}

/// As [`register`], by what the workspace has seen of this frame already where the landmark has a number there.
fn register_by<P: StageProbe>(
    number: Option<usize>,
    frame: &Frame,
    landmark: &Landmark,
    request: &Request<'_>,
    workspace: &mut Workspace,
    probe: &mut P,
) -> Result<Vec<Sighting>, Miss> {
    let grid = grid(frame, landmark, request)?;
    let Workspace { masker, mask, .. } = &mut *workspace;
    match number {
        Some(number) => masker.find_shared(number, frame, &grid, landmark, mask, probe),
        None => masker.find(frame, &grid, landmark, mask, probe),
    }
    staged(probe, Stage::Components, || workspace.components.find(&workspace.mask));
    choose_candidates(&workspace.components, &mut workspace.candidates);
    let mut sightings = workspace.spare_lists.pop().unwrap_or_default();
    let mut best_refused: Option<f32> = None;
    for at in 0..workspace.candidates.len() {
        let sighting = examine(frame, landmark, &grid, request, workspace, at, probe);
        if request.shape_veto.rules_out(sighting.shape_score) {
            best_refused = [best_refused, sighting.shape_score].into_iter().flatten().reduce(f32::max);
            workspace.spare.push(sighting);
        } else {
            sightings.push(sighting);
        }
    }
    score::rank(&mut sightings, |dropped| workspace.spare.push(dropped));
    if !sightings.is_empty() {
        return Ok(sightings);
    }
    workspace.recycle(sightings);
    Err(best_refused.map_or(Miss::NoColour { best: None }, |score| Miss::WrongShape { score }))
}

/// The windows to look at.
fn grid(frame: &Frame, landmark: &Landmark, request: &Request<'_>) -> Result<DoubledGrid, Miss> {
    let whole = RectPx::whole(frame.size());
    let region = match request.region {
        Some(region) if whole.width > 0 && whole.height > 0 => {
            region.clipped_to(frame.size()).ok_or(Miss::OutsideFrame)?
        }
        _ => whole,
    };
    DoubledGrid::new(region, landmark.window_px).ok_or(Miss::TooSmall)
}

/// The largest components, the largest first.
fn choose_candidates(components: &Components, candidates: &mut Vec<Component>) {
    candidates.clear();
    candidates.extend_from_slice(components.list());
    candidates.sort_unstable_by_key(Component::largest_first);
    candidates.truncate(MOST_CANDIDATES);
}

/// Outline, Hough, shape and measure of one candidate.
fn examine<P: StageProbe>(
    frame: &Frame,
    landmark: &Landmark,
    grid: &DoubledGrid,
    request: &Request<'_>,
    workspace: &mut Workspace,
    at: usize,
    probe: &mut P,
) -> Sighting {
    let Workspace { mask, components, candidates, outline, hough, spare, .. } = workspace;
    let component = &candidates[at];
    let runs = components.runs(component);
    staged(probe, Stage::Outline, || outline.trace(mask, runs[0]));
    let segments = staged(probe, Stage::Hough, || hough.segments(outline));
    let shape_score = staged(probe, Stage::Shape, || shape::fit(landmark.shape, outline, segments));
    let evidence = Evidence { mask, component, runs, outline, segments, shape_score };
    let mut sighting = spare.pop().unwrap_or_default();
    staged(probe, Stage::Measure, || measure::sighting(frame, grid, &evidence, &mut sighting));
    sighting.score = score::score(&sighting, landmark.window_px, request.prediction);
    sighting
}

fn staged<P: StageProbe, T>(probe: &mut P, stage: Stage, work: impl FnOnce() -> T) -> T {
    probe.begin(stage);
    let result = work();
    probe.end(stage);
    result
}
