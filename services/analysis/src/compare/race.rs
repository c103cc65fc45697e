//! All methods over all frames.

use std::collections::BTreeMap;
use std::sync::Arc;

use ingest::camera_decoder::CameraDecoder;
use ingest::encoded::EncodedFrame;
use vision::{Frame, FrameStamp, Landmark, PointPx, RectPx, Sighting};
use waymark_proto::v1;

use super::contender::Contender;
use super::figures::{MethodFigures, by_agreement, by_truth};
use super::method::Method;
use super::shots::Shot;
use super::statistical::Statistical;
use super::{CompareError, Judge, Question, Race, box_around, shots};
use crate::drive::Drive;
use crate::input::{Frames, Input, InputFrame, Live};
use crate::score::Claim;
use crate::stage_times::thread_cpu_ns;
use crate::truth::{Truth, meant_object};

/// What one method claimed, and what that cost.
#[derive(Clone, Debug)]
pub(crate) struct Lane {
    pub(crate) method: Method,
    /// By frame number.
    pub(crate) claims: BTreeMap<u64, Claim>,
    /// Thread CPU time of every frame, ms.
    pub(crate) cost_ms: Vec<(u64, f64)>,
    /// Where the object really was; of several that the landmark stands for, the one nearest to the claim.
    pub(crate) truth: Option<Truth>,
}

/// What happened, frame by frame.
#[derive(Debug, Default)]
pub(crate) struct Course {
    /// The numbers of the frames that were looked at.
    pub(crate) numbers: Vec<u64>,
    pub(crate) lanes: Vec<Lane>,
    /// Where the object really was, where that is known; of several, the largest.
    pub(crate) truth: Option<Truth>,
    /// The frames worth a look.
    pub(crate) shots: Vec<Shot>,
}

/// Compares the methods; `on_frame` hears of each frame.
///
/// # Errors
/// When an input or its truth cannot be read, or nothing says what to look for.
pub fn compare(question: &Question, mut on_frame: impl FnMut()) -> Result<Vec<Race>, CompareError> {
    let mut races = Vec::new();
    for input in &question.inputs {
        let truth = RecordedTruth::of(input)?;
        let runners = run(question, input, &truth, &mut on_frame)?;
        for ((camera, _), runner) in runners {
            races.push(runner.finish(question, input, camera)?);
        }
    }
    for (race, input) in races.iter_mut().map(|race| {
        let input = question.inputs.iter().find(|input| input.given == race.input);
        (race, input)
    }) {
        if let Some(input) = input {
            shots::take(race, input)?;
        }
    }
    Ok(races)
}

type Key = (Option<Arc<str>>, String);

fn run(
    question: &Question,
    input: &Input,
    truth: &RecordedTruth,
    on_frame: &mut impl FnMut(),
) -> Result<BTreeMap<Key, Runner>, CompareError> {
    let mut runners: BTreeMap<Key, Runner> = BTreeMap::new();
    let mut decoders: BTreeMap<Option<Arc<str>>, CameraDecoder> = BTreeMap::new();
    let mut own: Vec<Landmark> = question.landmarks.clone();
    let mut lost = 0;
    for InputFrame { frame: number, camera, picture, live, .. } in input.open()? {
        on_frame();
        if own.is_empty()
            && let Live::Registered { landmarks, .. } = live
        {
            own = landmarks.landmarks.iter().map(|landmark| landmark.as_ref().clone()).collect();
        }
        let Some((encoded, frame)) = decoded(&mut decoders, &camera, picture.ok()) else {
            lost += 1;
            continue;
        };
        for landmark in &own {
            let key = (camera.clone(), landmark.id.clone());
            let runner = runners.entry(key).or_insert_with(|| Runner::new(landmark, &question.methods));
            let known = camera.as_ref().and_then(|camera| truth.at(camera, &encoded));
            runner.on_frame(number, &frame, &encoded, known);
        }
    }
    runners.values_mut().for_each(|runner| runner.lost = lost);
    let given = || input.given.clone();
    match (own.is_empty(), runners.is_empty()) {
        (true, _) => Err(CompareError::NoLandmark { given: given() }),
        (false, true) => Err(CompareError::NoFrame { given: given() }),
        (false, false) => Ok(runners),
    }
}

/// A frame that can be decoded.
pub(super) fn decoded(
    decoders: &mut BTreeMap<Option<Arc<str>>, CameraDecoder>,
    camera: &Option<Arc<str>>,
    picture: Option<EncodedFrame>,
) -> Option<(EncodedFrame, Frame)> {
    let picture = picture?;
    let decoder = decoders.entry(camera.clone()).or_default();
    let frame = decoder.decode_into(&picture, Vec::new()).ok()?;
    Some((picture, frame))
}

/// What a simulator's recording says of each picture.
struct RecordedTruth {
    drive: Option<Drive>,
}

impl RecordedTruth {
    fn of(input: &Input) -> Result<Self, CompareError> {
        let drive = input.recording().map(|(file, _)| Drive::read(file)).transpose()?;
        Ok(Self { drive })
    }

    fn at(&self, camera: &str, picture: &EncodedFrame) -> Option<v1::Truth> {
        let frames = &self.drive.as_ref()?.cameras.get(camera)?.frames;
        frames.get(&(picture.captured_at, picture.sequence as u32))?.truth.clone()
    }
}

/// The methods at work on one landmark in one camera's frames.
struct Runner {
    landmark: Landmark,
    scout: Statistical,
    contenders: Vec<(Contender, Lane)>,
    numbers: Vec<u64>,
    /// What a recording says is true.
    recorded: BTreeMap<u64, v1::Truth>,
    shown_in: Option<u64>,
    lost: u64,
}

impl Runner {
    fn new(landmark: &Landmark, methods: &[Method]) -> Self {
        let lane =
            |method: Method| Lane { method, claims: BTreeMap::new(), cost_ms: Vec::new(), truth: None };
        let contenders = methods.iter().map(|&method| (Contender::new(method, landmark), lane(method)));
        Self {
            landmark: landmark.clone(),
            scout: Statistical::new(Method::Adaptive, landmark),
            contenders: contenders.collect(),
            numbers: Vec::new(),
            recorded: BTreeMap::new(),
            shown_in: None,
            lost: 0,
        }
    }

    fn on_frame(&mut self, number: u64, frame: &Frame, picture: &EncodedFrame, known: Option<v1::Truth>) {
        let stamp = FrameStamp { sequence: picture.sequence, captured_at: picture.captured_at };
        self.numbers.push(number);
        self.recorded.extend(known.map(|truth| (number, truth)));
        if self.shown_in.is_none()
            && let Some(seen) = self.scout.sighting(frame, stamp)
            && let Some(object) = extent(&seen, frame)
        {
            self.shown_in = Some(number);
            self.contenders
                .iter_mut()
                .for_each(|(contender, _)| contender.show(frame, object, Claim::from(&seen)));
        }
        for (contender, lane) in &mut self.contenders {
            let before_ns = thread_cpu_ns();
            let claim = contender.look(frame, stamp);
            lane.cost_ms.push((number, (thread_cpu_ns() - before_ns) as f64 * 1e-6));
            lane.claims.extend(claim.map(|claim| (number, claim)));
        }
    }

    fn finish(
        self,
        question: &Question,
        input: &Input,
        camera: Option<Arc<str>>,
    ) -> Result<Race, CompareError> {
        let given = question.truth.as_ref().map(|path| Truth::read(path, &self.landmark.id)).transpose()?;
        let given = given.map(|mut truth| {
            truth.frames.retain(|number, _| self.numbers.contains(number));
            truth
        });
        let truth_of = |claims: &BTreeMap<u64, Claim>| match &given {
            Some(truth) => Some(truth.clone()),
            None => recorded_truth(&self.recorded, &self.landmark.id, claims),
        };
        let truth = truth_of(&BTreeMap::new());
        let lanes =
            self.contenders.into_iter().map(|(_, lane)| Lane { truth: truth_of(&lane.claims), ..lane });
        let lanes: Vec<Lane> = lanes.collect();
        let methods: Vec<MethodFigures> = match truth {
            Some(_) => lanes.iter().filter_map(|lane| Some(by_truth(lane, lane.truth.as_ref()?))).collect(),
            None => by_agreement(&lanes, &self.numbers),
        };
        Ok(Race {
            input: input.given.clone(),
            camera: camera.map(|camera| camera.to_string()),
            landmark: self.landmark.id,
            frames: self.numbers.len() as u64,
            lost: self.lost,
            template_frame: self.shown_in,
            judge: if truth.is_some() { Judge::Truth } else { Judge::Agreement },
            methods,
            course: Course { numbers: self.numbers, lanes, truth, shots: Vec::new() },
        })
    }
}

/// What a recording says of the object that is meant in each frame; `None` where it says nothing.
fn recorded_truth(
    recorded: &BTreeMap<u64, v1::Truth>,
    landmark: &str,
    claims: &BTreeMap<u64, Claim>,
) -> Option<Truth> {
    let meant = |(number, truth): (&u64, &v1::Truth)| {
        let claim: Vec<Claim> = claims.get(number).copied().into_iter().collect();
        (*number, meant_object(truth, landmark, &claim))
    };
    (!recorded.is_empty()).then(|| Truth { frames: recorded.iter().map(meant).collect() })
}

/// The rim of background around a template, as a part of the object's side and at least in pixels: a template of one
/// colour alone correlates with nothing, its edge is what it is known by.
const RIM_PART: f32 = 0.15;
const LEAST_RIM_PX: f32 = 2.0;

/// The box around a sighting with a rim: that of its outline, or as large as its area where it has none.
fn extent(seen: &Sighting, frame: &Frame) -> Option<RectPx> {
    let side = seen.area_px2.sqrt();
    let whole = |of: fn(&PointPx) -> f32| {
        let values = || seen.outline.iter().map(of);
        values().fold(f32::NEG_INFINITY, f32::max) - values().fold(f32::INFINITY, f32::min)
    };
    let (width, height) =
        if seen.outline.is_empty() { (side, side) } else { (whole(|point| point.x), whole(|point| point.y)) };
    let rimmed = |side: f32| side + 2.0 * (RIM_PART * side).max(LEAST_RIM_PX);
    box_around(seen.centroid, rimmed(width), rimmed(height), frame.size())
}

/// How many frames an input says that it has.
#[must_use]
pub fn expected_frames(inputs: &[Input]) -> u64 {
    let frames = |input: &Input| input.open().map_or(0, |frames: Frames| frames.size_hint().0 as u64);
    inputs.iter().map(frames).sum()
}
