//! Following landmarks from frame to frame: predict → gate → register → update, a state machine without a clock.
//!
//! The same frames with the same stamps, options and landmark sets give the same outcomes, and a [`FollowState`]
//! taken between two frames continues exactly where it was taken.

mod budget;
mod conclude;
mod faithful;
mod pursue;
mod reason;
pub(crate) mod report;
mod state;

pub use state::{FollowState, LandmarkState, Track};

use std::fmt;
use std::sync::Arc;

use crate::adaptive::memory::Memory;
use crate::adaptive::{Finder, Light, Likeness, Search, Tracer, noise, sharpness};
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::{Landmark, LandmarkSet};
use crate::outcome::{LandmarkOutcome, Miss, Outcome};
use crate::predict::PredictionMethod;
use crate::probe::StageProbe;
use crate::register::{Request, ShapeVeto, Workspace, register_all};
use crate::timestamp::Timestamp;
use budget::Budget;
use report::{Ids, Report};

/// How a landmark is registered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// The thesis as settled: fixed statistics and tolerances, the whole frame, no gate.
    Faithful,
    /// With gain, noise, scale, gate and soft edges followed.
    #[default]
    Adaptive,
}

impl Mode {
    /// The name used on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Faithful => "faithful",
            Self::Adaptive => "adaptive",
        }
    }
}

/// How to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowOptions {
    /// How a landmark is registered.
    pub mode: Mode,
    /// How the next place is told from the earlier ones.
    pub prediction: PredictionMethod,
    /// What a misfit of the shape means.
    pub shape_veto: ShapeVeto,
    /// At most this many objects are followed for one landmark.
    pub max_instances: u32,
    /// At most this many pixels are searched in one frame, counted once for every landmark; what is left is reported
    /// as skipped and comes first in the next frame.
    pub budget_px: u64,
}

impl Default for FollowOptions {
    fn default() -> Self {
        Self {
            mode: Mode::default(),
            prediction: PredictionMethod::default(),
            shape_veto: ShapeVeto::default(),
            max_instances: 32,
            budget_px: 24 * 1280 * 720,
        }
    }
}

/// Which frame it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameStamp {
    /// Its number in its stream.
    pub sequence: u64,
    /// When it was captured.
    pub captured_at: Timestamp,
}

/// What all landmarks of a frame share.
struct Scene<'a> {
    frame: &'a Frame,
    captured_at: Timestamp,
    noise_variance: [f32; 3],
    blur_px: f32,
    options: FollowOptions,
}

impl<'a> Scene<'a> {
    /// What it takes to look for a landmark in a part of the frame, at `seeds` places closely.
    fn search(
        &self,
        landmark: &'a Landmark,
        region: RectPx,
        likeness: Likeness<'a>,
        light: Light,
        seeds: usize,
    ) -> Search<'a> {
        let Self { frame, noise_variance, blur_px, .. } = *self;
        Search { frame, region, landmark, likeness, light, noise_variance, blur_px, limit: seeds }
    }
}

/// Follows all landmarks of a set through the frames of one camera.
pub struct Follow {
    options: FollowOptions,
    set: LandmarkSet,
    state: FollowState,
    /// Memory only: no outcome depends on what earlier frames left in it.
    workspace: Workspace,
    tools: Tools,
    lists: Lists,
}

/// Lists that are filled anew in every frame, and what came back.
#[derive(Default)]
struct Lists {
    /// The order in which landmarks are looked for.
    order: Vec<usize>,
    /// What was found of each, in the order of the set.
    by_landmark: Vec<Vec<LandmarkOutcome>>,
    /// For the next outcome.
    outcomes: Vec<LandmarkOutcome>,
    ids: Ids,
}

/// What finds and traces objects in `adaptive` mode, with its memory.
#[derive(Default)]
struct Tools {
    finder: Finder,
    tracer: Tracer,
    /// What lasts for one landmark's turn in a frame.
    memory: Memory,
}

impl fmt::Debug for Follow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { options, set, state, workspace: _, tools: _, lists: _ } = self;
        f.debug_struct("Follow")
            .field("options", options)
            .field("set", set)
            .field("state", state)
            .finish_non_exhaustive()
    }
}

impl Follow {
    /// A follower that has seen nothing yet.
    #[must_use]
    pub fn new(options: FollowOptions, set: LandmarkSet) -> Self {
        Self::restore(options, set, FollowState::default())
    }

    /// A follower that continues from `state`. Landmarks that are not the same in `set` start anew.
    #[must_use]
    pub fn restore(options: FollowOptions, set: LandmarkSet, state: FollowState) -> Self {
        let mut follow = Self {
            options,
            set: LandmarkSet::default(),
            state,
            workspace: Workspace::default(),
            tools: Tools::default(),
            lists: Lists::default(),
        };
        follow.set_landmarks(set);
        follow
    }

    /// Changes what is looked for. Landmarks with the same id and digest keep their tracks.
    pub fn set_landmarks(&mut self, set: LandmarkSet) {
        let mut old = std::mem::take(&mut self.state.landmarks);
        let known = |landmark: &Arc<Landmark>| {
            let same = |state: &LandmarkState| state.id == landmark.id && state.digest == landmark.digest;
            match old.iter().position(same) {
                Some(at) => old.swap_remove(at),
                None => LandmarkState::new(landmark),
            }
        };
        self.state.landmarks = set.landmarks.iter().map(known).collect();
        self.set = set;
    }

    /// What is looked for.
    #[must_use]
    pub fn landmarks(&self) -> &LandmarkSet {
        &self.set
    }

    /// How it follows.
    #[must_use]
    pub fn options(&self) -> &FollowOptions {
        &self.options
    }

    /// All that later frames depend on.
    #[must_use]
    pub fn state(&self) -> &FollowState {
        &self.state
    }

    /// Registers every landmark in `frame`.
    pub fn on_frame<P: StageProbe>(&mut self, frame: &Frame, stamp: FrameStamp, probe: &mut P) -> Outcome {
        self.state.noise_variance = noise::variance(frame);
        let scene = Scene {
            frame,
            captured_at: stamp.captured_at,
            noise_variance: self.state.noise_variance,
            blur_px: self.blur_px(frame),
            options: self.options,
        };
        let landmarks = self.register_all(&scene, probe);
        self.state.last = Some(stamp);
        Outcome {
            sequence: stamp.sequence,
            captured_at: stamp.captured_at,
            frame_size: frame.size(),
            set_version: self.set.version,
            landmarks,
        }
    }

    /// Takes back an outcome that nobody needs any more. Where every outcome comes back, frames ask for no memory once as
    /// much is there as the busiest of them took.
    pub fn recycle(&mut self, outcome: Outcome) {
        let mut outcomes = outcome.landmarks;
        for LandmarkOutcome { landmark, result, .. } in outcomes.drain(..) {
            self.lists.ids.recycle(landmark);
            if let Ok(sighting) = result {
                self.workspace.recycle_sighting(sighting);
            }
        }
        self.lists.outcomes = outcomes;
    }

    /// The frame's blur where anything asks for it: what is written on round signs.
    fn blur_px(&self, frame: &Frame) -> f32 {
        let is_round = |landmark: &Arc<Landmark>| landmark.shape.is_round();
        let asked = self.options.mode == Mode::Adaptive && self.set.landmarks.iter().any(is_round);
        if asked { sharpness::blur_px(frame) } else { 0.0 }
    }

    /// Every landmark, in the order of the set. Those that are followed come first; the others begin with the one
    /// that the last frame's budget did not reach.
    fn register_all<P: StageProbe>(&mut self, scene: &Scene<'_>, probe: &mut P) -> Vec<LandmarkOutcome> {
        let count = self.set.landmarks.len();
        let mut lists = std::mem::take(&mut self.lists);
        self.set_order(&mut lists.order);
        lists.by_landmark.resize_with(count, Vec::new);
        let mut budget = Budget::new(self.options.budget_px);
        if self.options.mode == Mode::Faithful {
            self.register_faithful(scene, &mut lists, &mut budget, probe);
        }
        let mut unreached = None;
        for &at in &lists.order {
            let outcomes = &mut lists.by_landmark[at];
            if self.options.mode == Mode::Adaptive {
                let report = Report { outcomes, ids: &mut lists.ids, workspace: &mut self.workspace };
                let (landmark, state) = (&self.set.landmarks[at], &mut self.state.landmarks[at]);
                pursue::landmark(scene, landmark, state, &mut budget, &mut self.tools, report, probe);
            }
            let skipped = outcomes.iter().any(|outcome| outcome.result == Err(Miss::Skipped));
            if skipped && unreached.is_none() && self.state.landmarks[at].tracks.is_empty() {
                unreached = Some(at);
            }
        }
        self.state.turn = unreached.unwrap_or(0);
        let mut outcomes = std::mem::take(&mut lists.outcomes);
        lists.by_landmark.iter_mut().for_each(|found| outcomes.append(found));
        self.lists = lists;
        outcomes
    }

    /// Those that are followed first, then the others; each from the one on whose turn it is.
    fn set_order(&self, order: &mut Vec<usize>) {
        let count = self.set.landmarks.len();
        let first = self.state.turn.min(count);
        let in_turn = || (first..count).chain(0..first);
        let unseen = |&at: &usize| self.state.landmarks[at].tracks.is_empty();
        order.clear();
        order.extend(in_turn().filter(|at| !unseen(at)));
        order.extend(in_turn().filter(unseen));
    }

    /// All that the budget allows at once: they share passes over the frame.
    fn register_faithful<P: StageProbe>(
        &mut self,
        scene: &Scene<'_>,
        lists: &mut Lists,
        budget: &mut Budget,
        probe: &mut P,
    ) {
        let Lists { order, by_landmark, ids, .. } = lists;
        let frame_px = u64::from(scene.frame.width()) * u64::from(scene.frame.height());
        let allowed = order.iter().take_while(|_| budget.spend(frame_px).is_some()).count();
        let (now, later) = order.split_at(allowed);
        let Self { set, state, workspace, .. } = self;
        for &at in later {
            by_landmark[at].push(report::missed_by(ids, &set.landmarks[at], 0, Miss::Skipped));
        }
        let request = Request { shape_veto: scene.options.shape_veto, ..Request::default() };
        let landmarks = now.iter().map(|&at| set.landmarks[at].as_ref());
        register_all(scene.frame, landmarks, &request, workspace, probe, |number, seen, workspace| {
            let at = now[number];
            let report = Report { outcomes: &mut by_landmark[at], ids, workspace };
            faithful::landmark(scene, &set.landmarks[at], &mut state.landmarks[at], seen, report);
        });
    }
}
