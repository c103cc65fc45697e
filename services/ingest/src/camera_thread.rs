//! The one thread of a camera: takes the newest picture, decodes it, lets [`vision::follow::Follow`] look at it, and
//! hands on what it saw. It owns the state machine, so nothing locks it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tokio::sync::{mpsc, watch};
use vision::follow::{Follow, FollowOptions, FollowState, FrameStamp};
use vision::frame::decode::{self, DecodeError, DecodeLimits, RawPicture};
use vision::{Frame, LandmarkSet, NoProbe, Outcome};

use crate::encoded::{EncodedFrame, Encoding};
use crate::mailbox::Mailbox;

/// A picture that was looked at, and what it said.
#[derive(Debug)]
pub struct Registered {
    /// The picture as it arrived.
    pub picture: Arc<EncodedFrame>,
    /// What was looked for.
    pub landmarks: Arc<LandmarkSet>,
    /// What was seen in it.
    pub outcome: Outcome,
    /// What the outcome of the next picture depends on.
    pub state: FollowState,
    /// Wall time spent decoding.
    pub decode_time: Duration,
    /// Wall time spent registering all landmarks.
    pub register_time: Duration,
    /// When that was done.
    pub finished_at: Instant,
}

/// What a camera thread could not keep, readable while it runs.
#[derive(Debug, Default)]
pub struct CameraCounters {
    registered: AtomicU64,
    undecodable: AtomicU64,
    unread: AtomicU64,
}

impl CameraCounters {
    /// Pictures that were looked at.
    pub fn registered(&self) -> u64 {
        self.registered.load(Ordering::Relaxed)
    }

    /// Pictures that could not be decoded.
    pub fn undecodable(&self) -> u64 {
        self.undecodable.load(Ordering::Relaxed)
    }

    /// Results that nobody took in time.
    pub fn unread(&self) -> u64 {
        self.unread.load(Ordering::Relaxed)
    }
}

/// Where a camera thread's results go; neither end can make the thread wait.
#[derive(Debug)]
pub struct Outlets {
    /// Every result, for journal and publishers; bounded, what does not fit is counted as unread.
    pub every: mpsc::Sender<Arc<Registered>>,
    /// The newest result, for whoever looks.
    pub latest: watch::Sender<Option<Arc<Registered>>>,
}

/// A running camera thread.
#[derive(Debug)]
pub struct CameraThread {
    mailbox: Arc<Mailbox<Arc<EncodedFrame>>>,
    counters: Arc<CameraCounters>,
    thread: JoinHandle<()>,
}

impl CameraThread {
    /// Starts the thread of camera `id`. It follows the newest set in `landmarks` until [`CameraThread::finish`].
    ///
    /// # Errors
    /// When the operating system gives no thread.
    pub fn spawn(
        id: &str,
        options: FollowOptions,
        landmarks: watch::Receiver<Arc<LandmarkSet>>,
        outlets: Outlets,
    ) -> std::io::Result<Self> {
        let mailbox = Arc::new(Mailbox::default());
        let counters = Arc::new(CameraCounters::default());
        let in_force = Arc::clone(&landmarks.borrow());
        let worker = Worker {
            camera: id.to_owned(),
            follow: Follow::new(options, in_force.as_ref().clone()),
            in_force,
            landmarks,
            outlets,
            counters: Arc::clone(&counters),
            pixels: Vec::new(),
            spare_state: FollowState::default(),
        };
        let thread = std::thread::Builder::new().name(format!("camera {id}")).spawn({
            let mailbox = Arc::clone(&mailbox);
            move || worker.run(&mailbox)
        })?;
        Ok(Self { mailbox, counters, thread })
    }

    /// Where pictures are put.
    pub fn mailbox(&self) -> Arc<Mailbox<Arc<EncodedFrame>>> {
        Arc::clone(&self.mailbox)
    }

    /// What was lost on the way.
    pub fn counters(&self) -> Arc<CameraCounters> {
        Arc::clone(&self.counters)
    }

    /// Takes no more pictures, looks at the one that is waiting, and ends. Returns false when the thread panicked.
    pub fn finish(self) -> bool {
        self.mailbox.close();
        self.thread.join().is_ok()
    }
}

struct Worker {
    camera: String,
    follow: Follow,
    /// What it follows.
    in_force: Arc<LandmarkSet>,
    landmarks: watch::Receiver<Arc<LandmarkSet>>,
    outlets: Outlets,
    counters: Arc<CameraCounters>,
    /// Memory of the last frame's pixels.
    pixels: Vec<u8>,
    /// Memory of an earlier result's state.
    spare_state: FollowState,
}

impl Worker {
    fn run(mut self, mailbox: &Mailbox<Arc<EncodedFrame>>) {
        while let Some(picture) = mailbox.take() {
            self.adopt_landmarks();
            match self.look_at(picture) {
                Ok(registered) => self.hand_on(registered),
                Err(error) => {
                    self.counters.undecodable.fetch_add(1, Ordering::Relaxed);
                    tracing::debug!(camera = self.camera, %error, "picture dropped");
                }
            }
        }
    }

    fn adopt_landmarks(&mut self) {
        if self.landmarks.has_changed().unwrap_or(false) {
            self.in_force = Arc::clone(&self.landmarks.borrow_and_update());
            self.follow.set_landmarks(self.in_force.as_ref().clone());
        }
    }

    fn look_at(&mut self, picture: Arc<EncodedFrame>) -> Result<Registered, DecodeError> {
        let started = Instant::now();
        let frame = decode_into(&picture, std::mem::take(&mut self.pixels))?;
        let decoded = Instant::now();
        let stamp = FrameStamp { sequence: picture.sequence, captured_at: picture.captured_at };
        let outcome = self.follow.on_frame(&frame, stamp, &mut NoProbe);
        let finished_at = Instant::now();
        self.pixels = frame.into_rgb();
        let (decode_time, register_time) = (decoded - started, finished_at - decoded);
        let mut state = std::mem::take(&mut self.spare_state);
        state.clone_from(self.follow.state());
        let landmarks = Arc::clone(&self.in_force);
        Ok(Registered { picture, landmarks, outcome, state, decode_time, register_time, finished_at })
    }

    /// Takes the memory of the result before back, where nobody looks at that any more.
    fn hand_on(&mut self, registered: Registered) {
        let registered = Arc::new(registered);
        self.counters.registered.fetch_add(1, Ordering::Relaxed);
        if self.outlets.every.try_send(Arc::clone(&registered)).is_err() {
            self.counters.unread.fetch_add(1, Ordering::Relaxed);
        }
        let before = self.outlets.latest.send_replace(Some(registered));
        if let Some(Registered { outcome, state, .. }) = before.and_then(Arc::into_inner) {
            self.follow.recycle(outcome);
            self.spare_state = state;
        }
    }
}

/// Decodes a picture with the limits that hold for every stream.
///
/// # Errors
/// When the bytes are damaged, of an unknown format or larger than the limits.
pub fn decode(picture: &EncodedFrame) -> Result<Frame, DecodeError> {
    decode_into(picture, Vec::new())
}

/// As [`decode()`], into the pixel storage of an earlier frame.
///
/// # Errors
/// As [`decode()`].
pub fn decode_into(picture: &EncodedFrame, pixels: Vec<u8>) -> Result<Frame, DecodeError> {
    let limits = DecodeLimits::default();
    match &picture.encoding {
        // A single picture of a stream is refused for what its first bytes are: no picture.
        Encoding::File | Encoding::H264 => decode::decode_into(&picture.bytes, &limits, pixels),
        &Encoding::Raw { width, height, step, ref order } => {
            let raw = RawPicture { width, height, encoding: order.parse()?, step, data: &picture.bytes };
            decode::decode_raw(raw, &limits, pixels)
        }
    }
}
