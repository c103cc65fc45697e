//! The leader's own cameras, looked through by people who teach it landmarks by hand; nothing is registered in them.

use std::sync::Arc;
use std::thread::JoinHandle;

use http_face::{Cameras, Depiction, Picture, PictureRequest};
use ingest::camera_thread;
use ingest::encoded::EncodedFrame;
use ingest::mailbox::Mailbox;
use ingest::picture_message::PictureKind;
use ingest::video_thread::{VideoQueue, VideoThread};
use ingest::view;
use tokio::time::Instant;
use waymark_proto::attachment::Attachment;
use waymark_proto::keys::{CameraStream, Id, VehicleKeys};
use zenoh::Session;
use zenoh::pubsub::Subscriber;
use zenoh::sample::Sample;

use crate::error::LeaderError;

/// A camera that is being looked through.
pub(crate) struct CameraWatch {
    subscriber: Subscriber<()>,
    mailbox: Arc<Mailbox<Arc<EncodedFrame>>>,
    video: VideoThread,
    showing: JoinHandle<()>,
}

/// Begins to look through these cameras of a vehicle.
pub(crate) async fn begin_all(
    session: &Session,
    keys: &VehicleKeys,
    ids: &[String],
) -> Result<(Arc<Cameras<EncodedFrame>>, Vec<CameraWatch>), LeaderError> {
    let cameras = cameras(ids);
    let mut watches = Vec::new();
    for id in ids {
        watches.push(CameraWatch::begin(session, keys, id, &cameras).await?);
    }
    Ok((cameras, watches))
}

/// The pictures of these cameras, none of which has sent one yet.
fn cameras(ids: &[String]) -> Arc<Cameras<EncodedFrame>> {
    let depiction = Depiction {
        render: Arc::new(|picture: &EncodedFrame, request: &PictureRequest| {
            view::encoded(camera_thread::decode(picture).map_err(|error| error.to_string())?, request)
        }),
        own_jpeg: EncodedFrame::own_jpeg,
        told: None,
    };
    Arc::new(Cameras::new(ids.iter().cloned(), &[], depiction))
}

impl CameraWatch {
    /// Begins to look through camera `id` of this vehicle.
    async fn begin(
        session: &Session,
        keys: &VehicleKeys,
        id: &str,
        cameras: &Arc<Cameras<EncodedFrame>>,
    ) -> Result<Self, LeaderError> {
        let camera = Id::new("camera", id)?;
        let mailbox = Arc::new(Mailbox::default());
        let no_thread = |source| LeaderError::Thread { camera: id.to_owned(), source };
        let video = VideoThread::spawn(id, Arc::clone(&mailbox)).map_err(no_thread)?;
        let showing = std::thread::Builder::new().name(format!("camera {id}")).spawn({
            let (mailbox, cameras, id) = (Arc::clone(&mailbox), Arc::clone(cameras), id.to_owned());
            move || show(&mailbox, &cameras, &id)
        });
        let showing = showing.map_err(no_thread)?;
        let mut intake = Intake { mailbox: Arc::clone(&mailbox), video: video.queue(), arrivals: 0 };
        let subscriber = session
            .declare_subscriber(keys.camera(&camera, CameraStream::Image))
            .callback_mut(move |sample| intake.accept(&sample))
            .await
            .map_err(LeaderError::zenoh("subscribing to a camera's pictures"))?;
        Ok(Self { subscriber, mailbox, video, showing })
    }

    /// Looks no more.
    pub(crate) async fn end(self) {
        if let Err(error) = self.subscriber.undeclare().await {
            tracing::debug!(%error, "subscription ended with the session");
        }
        let (video, mailbox, showing) = (self.video, self.mailbox, self.showing);
        let ended = tokio::task::spawn_blocking(move || {
            let is_sound = video.finish();
            mailbox.close();
            showing.join().is_ok() && is_sound
        });
        if !ended.await.is_ok_and(|is_sound| is_sound) {
            tracing::error!("a camera's thread ended early");
        }
    }
}

/// Shows the newest picture until the mailbox is closed.
fn show(mailbox: &Mailbox<Arc<EncodedFrame>>, cameras: &Cameras<EncodedFrame>, id: &str) {
    while let Some(source) = mailbox.take() {
        let Some(feed) = cameras.feed(id) else { return };
        let (sequence, captured_at_ns) = (source.sequence, source.captured_at.nanos);
        feed.publish(Picture { sequence, captured_at_ns, received_at: Instant::now(), source });
    }
}

/// A camera's way in; runs on Zenoh's receiving thread, so nothing here waits.
struct Intake {
    mailbox: Arc<Mailbox<Arc<EncodedFrame>>>,
    video: VideoQueue,
    arrivals: u64,
}

impl Intake {
    fn accept(&mut self, sample: &Sample) {
        self.arrivals += 1;
        let attachment = sample.attachment().and_then(|bytes| Attachment::from_bytes(&bytes.to_bytes()).ok());
        let sequence = attachment.map_or(self.arrivals, |attachment| attachment.sequence as u64);
        let encoding = sample.encoding().to_string();
        let schema = encoding.rsplit(';').next().unwrap_or_default();
        let Some(kind) = PictureKind::of_schema(schema) else {
            tracing::debug!(encoding, "no picture");
            return;
        };
        match kind.read(sequence, &sample.payload().to_bytes()) {
            Ok(picture) if kind == PictureKind::Video => self.video.offer(picture),
            Ok(picture) => drop(self.mailbox.put(Arc::new(picture))),
            Err(refused) => tracing::debug!(%refused, "picture refused"),
        }
    }
}
