//! Landmarks registered in the frames of many inputs: the same code as in a follower, without its mailbox, so that no
//! frame is dropped.

use std::collections::BTreeMap;
use std::error::Error;
use std::num::NonZeroUsize;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use ingest::camera_thread::decode_into;
use ingest::encoded::EncodedFrame;
use vision::follow::{Follow, FollowOptions, FrameStamp};
use vision::{LandmarkSet, NoProbe, Outcome};

use crate::input::{Frames, Input, InputFrame, Live};
use crate::stage_times::{FrameClock, StageTimes, thread_cpu_ns};

/// Events of one input that may wait for their turn in the result; a full queue makes that input's thread wait.
const QUEUED_EVENTS: usize = 256;

/// What to do with every input.
#[derive(Clone, Debug)]
pub struct Job {
    /// What to look for; `None` for what a recording itself says was looked for, in the frames it was looked for in.
    pub landmarks: Option<Arc<LandmarkSet>>,
    /// How.
    pub options: FollowOptions,
    /// Inputs worked on at the same time.
    pub threads: NonZeroUsize,
    /// Whether stages are timed, which itself costs a little.
    pub timing: Timing,
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
    },
    /// It could not be read or decoded, and is missing from the result.
    Lost(LostFrame),
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
    let (queues, work): (Vec<_>, Vec<_>) = inputs.into_iter().map(queue).unzip();
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

type Work = (Frames, SyncSender<Event>);

fn queue((input, frames): (Input, Frames)) -> ((Input, Receiver<Event>), Work) {
    let (sender, receiver) = sync_channel(QUEUED_EVENTS);
    ((input, receiver), (frames, sender))
}

/// Works on one input after the other until none is left or nobody listens any more.
fn register_inputs(work: &Mutex<std::vec::IntoIter<Work>>, job: &Job) -> StageTimes {
    let mut times = StageTimes::default();
    let next = || work.lock().unwrap_or_else(PoisonError::into_inner).next();
    while let Some((frames, events)) = next() {
        let mut cameras = Cameras { job, cameras: BTreeMap::new(), pixels: Vec::new(), times };
        for frame in frames {
            if let Some(event) = cameras.on_frame(frame)
                && events.send(event).is_err()
            {
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
    cameras: BTreeMap<Option<Arc<str>>, Camera>,
    /// Storage of the last frame, used again for the next.
    pixels: Vec<u8>,
    times: StageTimes,
}

/// One camera's state machine, and the set it was last given.
struct Camera {
    follow: Follow,
    set: Arc<LandmarkSet>,
}

impl Cameras<'_> {
    /// Looks at one frame; `None` when nobody looked at it when it was recorded either.
    fn on_frame(&mut self, input: InputFrame) -> Option<Event> {
        let InputFrame { frame, camera, name, picture, live } = input;
        let set = match (&self.job.landmarks, live) {
            (Some(given), _) => Arc::clone(given),
            (None, Live::Registered(set)) => set,
            (None, Live::Unknown) => Arc::default(),
            (None, Live::Dropped) => return None,
        };
        let outcome =
            picture.map_err(Into::into).and_then(|picture| self.outcome(camera.clone(), &set, &picture));
        Some(match outcome {
            Ok(outcome) => Event::Registered { frame, camera, outcome },
            Err(reason) => Event::Lost(LostFrame { name, reason }),
        })
    }

    fn outcome(
        &mut self,
        camera: Option<Arc<str>>,
        set: &Arc<LandmarkSet>,
        picture: &EncodedFrame,
    ) -> Result<Outcome, Box<dyn Error + Send + Sync>> {
        let begun_ns = thread_cpu_ns();
        let frame = decode_into(picture, std::mem::take(&mut self.pixels))?;
        let decoded_ns = thread_cpu_ns();
        let stamp = FrameStamp { sequence: picture.sequence, captured_at: picture.captured_at };
        let options = self.job.options;
        let camera = self.cameras.entry(camera).or_insert_with(|| Camera {
            follow: Follow::new(options, (**set).clone()),
            set: Arc::clone(set),
        });
        camera.adopt(set);
        let outcome = match self.job.timing {
            Timing::Off => camera.follow.on_frame(&frame, stamp, &mut NoProbe),
            Timing::On => {
                let mut clock = FrameClock::default();
                let outcome = camera.follow.on_frame(&frame, stamp, &mut clock);
                self.times.add(decoded_ns - begun_ns, thread_cpu_ns() - decoded_ns, &clock);
                outcome
            }
        };
        self.pixels = frame.into_rgb();
        Ok(outcome)
    }
}

impl Camera {
    fn adopt(&mut self, set: &Arc<LandmarkSet>) {
        if !Arc::ptr_eq(&self.set, set) && self.set != *set {
            self.follow.set_landmarks((**set).clone());
        }
        self.set = Arc::clone(set);
    }
}
