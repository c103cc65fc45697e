//! One camera from the subscription to the results: its thread, and everything around it.

use std::sync::Arc;

use ingest::camera_thread::{CameraThread, Outlets, Registered};
use ingest::video_thread::VideoThread;
use recording::Journal;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;
use vision::{LandmarkSet, Pinhole};
use waymark_proto::keys::{CameraStream, Id, VehicleKeys};
use zenoh::Session;
use zenoh::pubsub::Subscriber;

use crate::burned_in::BurnedIn;
use crate::calibration;
use crate::config::FollowerConfig;
use crate::counters::IntakeCounters;
use crate::error::FollowerError;
use crate::intake::Intake;
use crate::results::{Calibrated, Results};
use crate::station::{Losses, Station};
use crate::topics::CameraTopics;
use crate::web::Face;

/// Results that may wait to go out: some seconds of a fast camera.
const WAITING_RESULTS: usize = 256;

/// A camera that is ready to look.
pub(crate) struct Post {
    id: Id,
    thread: CameraThread,
    video: VideoThread,
    intake: Intake,
    results: Results,
    waiting: mpsc::Receiver<Arc<Registered>>,
    burned_in: Option<BurnedIn>,
    station: Arc<Station>,
    pinhole: watch::Sender<Option<Pinhole>>,
}

/// A camera that looks.
pub(crate) struct MannedPost {
    thread: CameraThread,
    video: VideoThread,
    subscriber: Subscriber<()>,
    _calibration: Subscriber<()>,
    handing_on: JoinHandle<()>,
    burned_in: Option<BurnedIn>,
    station: Arc<Station>,
}

impl Post {
    /// Starts the camera's thread; no picture reaches it yet.
    pub(crate) async fn set_up(
        id: Id,
        config: &FollowerConfig,
        own: &VehicleKeys,
        session: &Session,
        journal: &Arc<Journal>,
        landmarks: watch::Receiver<Arc<LandmarkSet>>,
    ) -> Result<Self, FollowerError> {
        let (every, waiting) = mpsc::channel(WAITING_RESULTS);
        let (latest, newest) = watch::channel(None);
        let (pinhole, known) = watch::channel(None);
        let calibrated = Calibrated(known);
        let options = config.follow_options();
        let no_thread = |source| FollowerError::Thread { camera: id.to_string(), source };
        let thread = CameraThread::spawn(id.as_str(), options, landmarks, Outlets { every, latest })
            .map_err(no_thread)?;
        let video = VideoThread::spawn(id.as_str(), thread.mailbox()).map_err(no_thread)?;
        let counters = Arc::new(IntakeCounters::default());
        let topics = CameraTopics::new(own, &id);
        let wanted = config.recorder.burned_in.then(|| Arc::clone(&topics.burned_in));
        let burned_in = wanted
            .map(|channel| BurnedIn::spawn(id.as_str(), channel, Arc::clone(journal)))
            .transpose()
            .map_err(no_thread)?;
        let (mailbox, journal_of_intake) = (thread.mailbox(), Arc::clone(journal));
        let intake =
            Intake::new(topics.clone(), journal_of_intake, mailbox, video.queue(), Arc::clone(&counters));
        let of_station = calibrated.clone();
        let results =
            Results::declare(session, own, &id, topics, options, Arc::clone(journal), calibrated).await?;
        let slot = burned_in.as_ref().map(BurnedIn::slot);
        let losses = Losses {
            intake: counters,
            video: video.counters(),
            thread: thread.counters(),
            burned_in: slot.clone(),
        };
        let station = Arc::new(Station::new(id.as_str(), thread.mailbox(), losses, newest, of_station));
        let results = results.drawn_into(slot);
        Ok(Self { id, thread, video, intake, results, waiting, burned_in, station, pinhole })
    }

    pub(crate) fn station(&self) -> Arc<Station> {
        Arc::clone(&self.station)
    }

    /// Lets pictures in.
    pub(crate) async fn begin(
        self,
        session: &Session,
        own: &VehicleKeys,
        face: Arc<Face>,
    ) -> Result<MannedPost, FollowerError> {
        let Self { id, thread, video, mut intake, results, waiting, burned_in, station, pinhole } = self;
        let (topics, journal) = (CameraTopics::new(own, &id), Arc::clone(&face.journal));
        let handing_on = tokio::spawn(results.run(waiting, Arc::clone(&station), face));
        let subscriber = session
            .declare_subscriber(own.camera(&id, CameraStream::Image))
            .callback_mut(move |sample| intake.accept(&sample))
            .await
            .map_err(FollowerError::zenoh("subscribing to a camera's pictures"))?;
        let calibration = calibration::record(session, own, &id, topics, journal, pinhole).await?;
        Ok(MannedPost {
            thread,
            video,
            subscriber,
            _calibration: calibration,
            handing_on,
            burned_in,
            station,
        })
    }
}

impl MannedPost {
    /// Takes no more pictures, and waits until everything seen is handed on. Returns the camera's id when its thread
    /// had panicked.
    pub(crate) async fn finish(self) -> Option<String> {
        if let Err(error) = self.subscriber.undeclare().await {
            tracing::debug!(%error, "subscription ended with the session");
        }
        let (video, thread) = (self.video, self.thread);
        let finished = tokio::task::spawn_blocking(move || [video.finish(), thread.finish()]).await;
        let sound = finished.is_ok_and(|sound| sound == [true; 2]);
        let handed_on = self.handing_on.await.is_ok();
        let burned_in = self.burned_in;
        let drawn = tokio::task::spawn_blocking(move || burned_in.is_none_or(BurnedIn::finish)).await;
        let sound = sound && drawn.is_ok_and(|sound| sound);
        (!(sound && handed_on)).then(|| self.station.id().to_owned())
    }
}
