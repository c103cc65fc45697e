//! Motion JPEG: `multipart/x-mixed-replace`, as curl, VLC, ffplay and an `<img>` element take it.
//!
//! The body is only asked for its next part when the connection has room, so a slow client skips pictures; one that
//! stops reading is cut off by the connection's stall guard.

use crate::cameras::{Camera, provenance};
use crate::counters::Refusal;
use crate::picture_request::PictureRequest;
use crate::pictures::{Picture, STALE_AFTER};
use crate::problem::Problem;
use axum::body::{Body, Bytes};
use axum::http::HeaderValue;
use axum::http::header::CONTENT_TYPE;
use axum::response::Response;
use bytes::BytesMut;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};
use tokio::time::Instant;

/// Streams served at once, over all cameras.
const MAX_STREAMS: usize = 16;

/// A stream ends when its camera has sent nothing for this long, rather than go on showing an old picture.
const END_AFTER: Duration = Duration::from_secs(10);

const BOUNDARY: &str = "waymark-frame";

/// Room for a bounded number of streams.
pub(crate) struct StreamSlots(Arc<Semaphore>);

impl Default for StreamSlots {
    fn default() -> Self {
        Self(Arc::new(Semaphore::new(MAX_STREAMS)))
    }
}

impl StreamSlots {
    pub(crate) fn take(&self) -> Result<OwnedSemaphorePermit, Problem> {
        Arc::clone(&self.0).try_acquire_owned().map_err(|_| {
            let detail =
                format!("{MAX_STREAMS} streams are being watched already; close one or use overlay.jpg");
            Problem::unavailable(detail, Duration::from_secs(5)).because(Refusal::Streams)
        })
    }
}

struct Motion<T> {
    camera: Arc<Camera<T>>,
    newest: watch::Receiver<Option<Picture<T>>>,
    request: PictureRequest,
    interval: Duration,
    next_at: Instant,
    shown: Option<(u64, i64)>,
    _slot: OwnedSemaphorePermit,
}

/// Starts a stream of at most one picture per `interval`.
pub(crate) fn stream<T: Send + Sync + 'static>(
    camera: Arc<Camera<T>>,
    request: PictureRequest,
    interval: Duration,
    slot: OwnedSemaphorePermit,
) -> Response {
    let newest = camera.feed.subscribe();
    let motion =
        Motion { camera, newest, request, interval, next_at: Instant::now(), shown: None, _slot: slot };
    let parts = futures_util::stream::unfold(motion, |mut motion| async move {
        let part = motion.next_part().await?;
        Some((Ok::<_, Infallible>(part), motion))
    });
    let mut response = Response::new(Body::from_stream(parts));
    let kind = HeaderValue::from_static("multipart/x-mixed-replace; boundary=waymark-frame");
    response.headers_mut().insert(CONTENT_TYPE, kind);
    response
}

impl<T: Send + Sync + 'static> Motion<T> {
    /// The next picture as a part, or `None` when the camera has stopped.
    async fn next_part(&mut self) -> Option<Bytes> {
        loop {
            tokio::time::sleep_until(self.next_at).await;
            let picture = self.next_picture().await?;
            self.shown = Some((picture.sequence, picture.captured_at_ns));
            self.next_at = (self.next_at + self.interval).max(Instant::now());
            match self.camera.views.view(&picture, &self.request).await {
                Ok(bytes) => return Some(part(&picture, &bytes)),
                // One picture that cannot be decoded does not end the stream: the next one may be good.
                Err(problem) => tracing::debug!(%problem, sequence = picture.sequence, "picture left out"),
            }
        }
    }

    async fn next_picture(&mut self) -> Option<Picture<T>> {
        let shown = self.shown;
        let is_new = |newest: &Option<Picture<T>>| {
            newest.as_ref().is_some_and(|picture| {
                Some((picture.sequence, picture.captured_at_ns)) != shown && picture.age() <= STALE_AFTER
            })
        };
        let newest = tokio::time::timeout(END_AFTER, self.newest.wait_for(is_new)).await.ok()?.ok()?;
        newest.clone()
    }
}

fn part<T>(picture: &Picture<T>, jpeg: &Bytes) -> Bytes {
    let mut part = BytesMut::with_capacity(jpeg.len() + 256);
    let head = format!("--{BOUNDARY}\r\ncontent-type: image/jpeg\r\ncontent-length: {}\r\n", jpeg.len());
    part.extend_from_slice(head.as_bytes());
    for (name, value) in provenance(picture) {
        part.extend_from_slice(name.as_bytes());
        part.extend_from_slice(b": ");
        part.extend_from_slice(value.as_bytes());
        part.extend_from_slice(b"\r\n");
    }
    part.extend_from_slice(b"\r\n");
    part.extend_from_slice(jpeg);
    part.extend_from_slice(b"\r\n");
    part.freeze()
}
