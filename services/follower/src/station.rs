//! One camera of this vehicle as status and page see it.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use http_face::{STALE_AFTER, camera_state};
use ingest::camera_thread::{CameraCounters, Registered};
use ingest::encoded::EncodedFrame;
use ingest::mailbox::Mailbox;
use ingest::video_thread::VideoCounters;
use tokio::sync::watch;
use vision::Place;

use crate::burned_in;
use crate::counters::IntakeCounters;
use crate::fps::RateMeter;
use crate::results::Calibrated;
use crate::status::{CameraStatus, Dropped, landmarks_from_outcome};
use crate::tap::now_ns;

/// Frames a second are counted over this time.
const RATE_SPAN: Duration = Duration::from_secs(3);

/// Where a camera's pictures can get lost, in the order of their way.
pub(crate) struct Losses {
    pub(crate) intake: Arc<IntakeCounters>,
    pub(crate) video: Arc<VideoCounters>,
    pub(crate) thread: Arc<CameraCounters>,
    /// Where pictures wait to be drawn, if they are.
    pub(crate) burned_in: Option<burned_in::Slot>,
}

/// What is known of one camera.
pub(crate) struct Station {
    id: String,
    mailbox: Arc<Mailbox<Arc<EncodedFrame>>>,
    losses: Losses,
    latest: watch::Receiver<Option<Arc<Registered>>>,
    calibrated: Calibrated,
    rate: Mutex<RateMeter>,
}

impl Station {
    pub(crate) fn new(
        id: &str,
        mailbox: Arc<Mailbox<Arc<EncodedFrame>>>,
        losses: Losses,
        latest: watch::Receiver<Option<Arc<Registered>>>,
        calibrated: Calibrated,
    ) -> Self {
        let rate = Mutex::new(RateMeter::over(RATE_SPAN));
        Self { id: id.to_owned(), mailbox, losses, latest, calibrated, rate }
    }

    pub(crate) fn id(&self) -> &str {
        &self.id
    }

    /// Takes note that a frame was registered.
    pub(crate) fn count_frame(&self, at: Instant) {
        self.rate.lock().unwrap_or_else(PoisonError::into_inner).observe(at);
    }

    /// Whether frames are coming: `Ok` with the newest one's age, or how it is instead.
    pub(crate) fn liveness(&self) -> Result<Duration, String> {
        match self.latest.borrow().as_ref().map(|newest| newest.finished_at.elapsed()) {
            None => Err(format!("camera {} has sent nothing yet", self.id)),
            Some(age) if age > STALE_AFTER => {
                Err(format!("camera {} has sent nothing for {:.1} s", self.id, age.as_secs_f64()))
            }
            Some(age) => Ok(age),
        }
    }

    pub(crate) fn dropped(&self) -> Dropped {
        let Losses { intake, video, thread, .. } = &self.losses;
        Dropped {
            missed: intake.missed_count(),
            overrun: video.overrun(),
            awaiting_keyframe: video.awaiting_keyframe(),
            replaced: self.mailbox.replaced(),
            undecodable: video.undecodable() + thread.undecodable(),
            refused: intake.refused_count(),
            unread: thread.unread(),
        }
    }

    /// Registered pictures that were not recorded with what was seen in them, because the next one was there; `None` where
    /// none are.
    pub(crate) fn not_burned_in(&self) -> Option<u64> {
        self.losses.burned_in.as_ref().map(|slot| slot.replaced())
    }

    pub(crate) fn registered(&self) -> u64 {
        self.losses.thread.registered()
    }

    /// Where the landmarks of a frame are.
    pub(crate) fn places(&self, registered: &Registered) -> Vec<Place> {
        self.calibrated.places(registered)
    }

    /// How the camera is now.
    pub(crate) fn status(&self) -> CameraStatus {
        let newest = self.latest.borrow().clone();
        let places = newest.as_ref().map_or_else(Vec::new, |newest| self.places(newest));
        self.status_with(newest.as_deref().map(|newest| (newest, places.as_slice())))
    }

    /// How the camera was when `newest` was its newest frame: by the time a frame is told of there may be another.
    pub(crate) fn status_with(&self, newest: Option<(&Registered, &[Place])>) -> CameraStatus {
        let (newest, places) = newest.unzip();
        let age = newest.map(|newest| newest.finished_at.elapsed());
        CameraStatus {
            id: self.id.clone(),
            state: camera_state(age),
            sequence: newest.map(|newest| newest.outcome.sequence),
            age_ms: age.map(milliseconds),
            fps: self.rate.lock().unwrap_or_else(PoisonError::into_inner).rate_hz(Instant::now()),
            latency_ms: newest.map(latency_ms),
            processing_ms: newest.map(|newest| milliseconds(newest.decode_time + newest.register_time)),
            dropped: self.dropped(),
            landmarks: newest.map_or_else(Vec::new, |newest| {
                landmarks_from_outcome(&newest.outcome, places.unwrap_or_default())
            }),
        }
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

/// From capture to the end of registration, by this machine's clock; meaningless when the camera's clock is another.
fn latency_ms(registered: &Registered) -> f64 {
    let finished_ns = i128::from(now_ns()) - registered.finished_at.elapsed().as_nanos() as i128;
    (finished_ns - i128::from(registered.outcome.captured_at.nanos)) as f64 * 1e-6
}
