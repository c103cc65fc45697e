//! Landmarks registered in the frames of many inputs: the same code as in a follower, without its mailbox, so that no
//! frame is dropped.

use std::collections::BTreeMap;
use std::error::Error;
use std::num::NonZeroUsize;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use ingest::camera_decoder::CameraDecoder;
use ingest::encoded::{EncodedFrame, Encoding};
use vision::follow::{Follow, FollowOptions, FollowState, FrameStamp};
use vision::{Frame, LandmarkSet, NoProbe, Outcome, Place, places};

use crate::follow_choice::FollowChoice;
use crate::input::{Frames, Input, InputFrame, Live, Past};
use crate::overlays::{OverlayError, OverlaySeries, Overlays, SeriesOrder, series_name};
use crate::stage_times::{FrameClock, StageTimes, thread_cpu_ns};

/// Events of one input that may wait for their turn in the result; a full queue makes that input's thread wait.
const QUEUED_EVENTS: usize = 256;

/// What to do with every input.
#[derive(Clone, Debug)]
pub struct Job {
    /// What to look for; `None` for what a recording itself says was looked for, in the frames it was looked for in.
    pub landmarks: Option<Arc<LandmarkSet>>,
    /// How, where it is not to be as a recording says.
    pub choice: FollowChoice,
    /// Inputs worked on at the same time.
    pub threads: NonZeroUsize,
    /// Whether stages are timed, which itself costs a little.
    pub timing: Timing,
    /// Where pictures with the result drawn in go.
    pub overlays: Option<Overlays>,
}

/// Whether stages are timed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Timing {
    /// Not timed.
    #[default]
    Off,
    /// Thread CPU time of each stage.
    On,
}

/// What came of one frame.
#[derive(Debug)]
pub enum Event {
    /// It was looked at.
    Registered {
        /// Counts from 1 within its input and camera.
        frame: u64,
        /// The camera's id, where known.
        camera: Option<Arc<str>>,
        /// What was seen.
        outcome: Outcome,
        /// Where that is: a place for each entry of the outcome.
        places: Vec<Place>,
        /// What the recording holds of the result that it had live, if it holds it.
        recorded: Option<Past>,
    },
    /// It could not be read or decoded, and is missing from the result.
    Lost(LostFrame),
    /// It was looked at, but the picture of that could not be written.
    NotDrawn(OverlayError),
}

/// A frame that is missing from the result.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {reason}")]
pub struct LostFrame {
    /// Its file, or its place in the input.
    pub name: String,
    /// Why.
    pub reason: Box<dyn Error + Send + Sync>,
}

/// Registers `job.landmarks` in all `inputs`, several at a time, and hands every event to `on_event` in the order of
/// the inputs and of the frames within each. Returns what the stages cost.
///
/// # Errors
/// The first error of `on_event`, which ends the work.
pub fn register<E>(
    inputs: Vec<(Input, Frames)>,
    job: &Job,
    mut on_event: impl FnMut(&Input, Event) -> Result<(), E>,
) -> Result<StageTimes, E> {
    let several = inputs.len() > 1;
    let numbers = (1..).map(|number| several.then_some(number));
    let (queues, work): (Vec<_>, Vec<_>) = inputs.into_iter().zip(numbers).map(queue).unzip();
    // Taken in the order of the inputs, so the input whose events are due is always being worked on.
    let work = Mutex::new(work.into_iter());
    let times = Mutex::new(StageTimes::default());
    std::thread::scope(|scope| {
        for _ in 0..job.threads.get().min(queues.len()) {
            scope.spawn(|| {
                let measured = register_inputs(&work, job);
                times.lock().unwrap_or_else(PoisonError::into_inner).merge(measured);
            });
        }
        queues
            .into_iter()
            .try_for_each(|(input, events)| events.iter().try_for_each(|event| on_event(&input, event)))
    })?;
    Ok(times.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// One input to work on.
struct Work {
    given: String,
    /// Its number, where there are several inputs.
    number: Option<usize>,
    frames: Frames,
    events: SyncSender<Event>,
}

fn queue(((input, frames), number): ((Input, Frames), Option<usize>)) -> ((Input, Receiver<Event>), Work) {
    let (events, receiver) = sync_channel(QUEUED_EVENTS);
    let work = Work { given: input.given.clone(), number, frames, events };
    ((input, receiver), work)
}

/// Works on one input after the other until none is left or nobody listens any more.
fn register_inputs(work: &Mutex<std::vec::IntoIter<Work>>, job: &Job) -> StageTimes {
    let mut times = StageTimes::default();
    let next = || work.lock().unwrap_or_else(PoisonError::into_inner).next();
    while let Some(Work { given, number, frames, events }) = next() {
        let series = |camera: Option<&str>| series_name(&given, number, camera);
        let mut cameras = Cameras {
            job,
            series: &series,
            only_input: number.is_none(),
            cameras: BTreeMap::new(),
            decoders: BTreeMap::new(),
            drawn: BTreeMap::new(),
            pixels: Vec::new(),
            times,
        };
        for frame in frames {
            if let Some(event) = cameras.on_frame(frame)
                && events.send(event).is_err()
            {
                return cameras.times;
            }
        }
        for event in cameras.finish_overlays() {
            if events.send(event).is_err() {
                return cameras.times;
            }
        }
        times = cameras.times;
    }
    times
}

/// The state of every camera of one input.
struct Cameras<'a> {
    job: &'a Job,
    /// What a camera's overlays are called.
    series: &'a dyn Fn(Option<&str>) -> String,
    only_input: bool,
    cameras: BTreeMap<Option<Arc<str>>, Camera>,
    decoders: BTreeMap<Option<Arc<str>>, CameraDecoder>,
    drawn: BTreeMap<Option<Arc<str>>, OverlaySeries>,
    /// Storage of the last frame, used again for the next.
    pixels: Vec<u8>,
    times: StageTimes,
}

/// What to do with one frame.
struct Plan {
    set: Arc<LandmarkSet>,
    options: FollowOptions,
    /// Where to stand before it, when not where the frame before has led.
    state: Option<FollowState>,
}

/// One camera's state machine, and the set it was last given.
struct Camera {
    follow: Follow,
    set: Arc<LandmarkSet>,
}

impl Cameras<'_> {
    /// Looks at one frame; `None` when nobody looked at it when it was recorded either.
    fn on_frame(&mut self, input: InputFrame) -> Option<Event> {
        let InputFrame { frame, camera, name, picture, live, pinhole } = input;
        let recorded = match &live {
            Live::Registered { result, .. } => *result,
            Live::Unknown | Live::Dropped => None,
        };
        let Some(plan) = self.plan(live) else {
            self.pass_over(&camera, &picture.ok()?);
            return None;
        };
        let set = Arc::clone(&plan.set);
        let seen = picture.map_err(Into::into).and_then(|picture| self.look_at(&camera, plan, &picture));
        Some(match seen {
            Ok((mut picture, outcome)) => {
                let drawn = self.draw(frame, &camera, &mut picture, &outcome);
                self.pixels = picture.into_rgb();
                match drawn {
                    Ok(()) => {
                        let places = places(&outcome, &set, pinhole.as_ref());
                        Event::Registered { frame, camera, outcome, places, recorded }
                    }
                    Err(error) => Event::NotDrawn(error),
                }
            }
            Err(reason) => Event::Lost(LostFrame { name, reason }),
        })
    }

    /// What to do with a frame; `None` when it is not to be looked at.
    fn plan(&self, live: Live) -> Option<Plan> {
        let choice = self.job.choice;
        let afresh = |set| Plan { set, options: choice.over(None), state: None };
        match (&self.job.landmarks, live) {
            (Some(given), _) => Some(afresh(Arc::clone(given))),
            (None, Live::Registered { landmarks, options: recorded, state, .. }) => {
                let options = choice.over(recorded);
                // Another way of following leads elsewhere; it has a past of its own.
                Some(Plan { set: landmarks, options, state: state.filter(|_| recorded == Some(options)) })
            }
            (None, Live::Unknown) => Some(afresh(Arc::default())),
            (None, Live::Dropped) => None,
        }
    }

    fn look_at(
        &mut self,
        camera: &Option<Arc<str>>,
        plan: Plan,
        picture: &EncodedFrame,
    ) -> Result<(Frame, Outcome), Box<dyn Error + Send + Sync>> {
        let begun_ns = thread_cpu_ns();
        let decoder = self.decoders.entry(camera.clone()).or_default();
        let frame = decoder.decode_into(picture, std::mem::take(&mut self.pixels))?;
        let decoded_ns = thread_cpu_ns();
        let stamp = FrameStamp { sequence: picture.sequence, captured_at: picture.captured_at };
        let camera = self.cameras.entry(camera.clone()).or_insert_with(|| Camera {
            follow: Follow::new(plan.options, (*plan.set).clone()),
            set: Arc::clone(&plan.set),
        });
        camera.adopt(plan);
        let outcome = match self.job.timing {
            Timing::Off => camera.follow.on_frame(&frame, stamp, &mut NoProbe),
            Timing::On => {
                let mut clock = FrameClock::default();
                let outcome = camera.follow.on_frame(&frame, stamp, &mut clock);
                self.times.add(decoded_ns - begun_ns, thread_cpu_ns() - decoded_ns, &clock);
                outcome
            }
        };
        Ok((frame, outcome))
    }

    /// Nobody looks at it, but those after it in its stream need it.
    fn pass_over(&mut self, camera: &Option<Arc<str>>, picture: &EncodedFrame) {
        if picture.encoding == Encoding::H264 {
            let decoder = self.decoders.entry(camera.clone()).or_default();
            let pixels = std::mem::take(&mut self.pixels);
            // What is damaged here shows in the first picture that somebody looks at.
            self.pixels = decoder.decode_into(picture, pixels).map(Frame::into_rgb).unwrap_or_default();
        }
    }

    fn draw(
        &mut self,
        number: u64,
        camera: &Option<Arc<str>>,
        frame: &mut Frame,
        outcome: &Outcome,
    ) -> Result<(), OverlayError> {
        let Some(overlays) = &self.job.overlays else { return Ok(()) };
        let place =
            if self.only_input && self.drawn.is_empty() { SeriesOrder::First } else { SeriesOrder::Later };
        let series = self
            .drawn
            .entry(camera.clone())
            .or_insert_with(|| overlays.series(&(self.series)(camera.as_deref()), place));
        series.write(number, frame, outcome)
    }

    fn finish_overlays(&mut self) -> Vec<Event> {
        let drawn = std::mem::take(&mut self.drawn).into_values();
        drawn.filter_map(|series| series.finish().err()).map(Event::NotDrawn).collect()
    }
}

impl Camera {
    fn adopt(&mut self, Plan { set, options, state }: Plan) {
        if let Some(state) = state {
            self.follow = Follow::restore(options, (*set).clone(), state);
        } else if !Arc::ptr_eq(&self.set, &set) && self.set != set {
            self.follow.set_landmarks((*set).clone());
        }
        self.set = set;
    }
}
