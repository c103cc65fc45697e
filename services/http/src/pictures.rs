//! The newest picture of one camera: published by its owner, waited for by any number of viewers.

use crate::problem::Problem;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::Instant;

/// A picture older than this is not shown as live.
pub const STALE_AFTER: Duration = Duration::from_secs(2);

/// How a camera is whose newest picture has this age: `waiting` for its first, `stale` or `live`.
#[must_use]
pub fn camera_state(age: Option<Duration>) -> &'static str {
    match age {
        None => "waiting",
        Some(age) if age > STALE_AFTER => "stale",
        Some(_) => "live",
    }
}

/// One picture and what belongs to it; `T` is whatever the owner draws from.
#[derive(Debug)]
pub struct Picture<T> {
    /// The frame's number in its stream.
    pub sequence: u64,
    /// When it was captured, ns since the Unix epoch.
    pub captured_at_ns: i64,
    /// When this process received it; ages count from here, so that a stepped clock cannot make a picture young.
    pub received_at: Instant,
    /// What to draw from: the encoded frame, and the outcome that belongs to it.
    pub source: Arc<T>,
}

impl<T> Clone for Picture<T> {
    fn clone(&self) -> Self {
        let Self { sequence, captured_at_ns, received_at, source } = self;
        Self {
            sequence: *sequence,
            captured_at_ns: *captured_at_ns,
            received_at: *received_at,
            source: Arc::clone(source),
        }
    }
}

impl<T> Picture<T> {
    /// Time since it was received.
    #[must_use]
    pub fn age(&self) -> Duration {
        self.received_at.elapsed()
    }
}

/// Where a camera's owner puts each picture; keeps only the newest and never waits for a viewer.
#[derive(Debug)]
pub struct PictureFeed<T> {
    newest: watch::Sender<Option<Picture<T>>>,
}

impl<T> Default for PictureFeed<T> {
    fn default() -> Self {
        Self { newest: watch::Sender::new(None) }
    }
}

impl<T> PictureFeed<T> {
    /// Replaces the newest picture and wakes whoever waits for one.
    pub fn publish(&self, picture: Picture<T>) {
        self.newest.send_replace(Some(picture));
    }

    /// The newest picture, however old it is.
    #[must_use]
    pub fn newest(&self) -> Option<Picture<T>> {
        self.newest.borrow().clone()
    }

    /// The newest picture, when there is one and it is not stale.
    ///
    /// # Errors
    /// 503 with the age when it is stale, or without when there was never one.
    pub fn latest(&self) -> Result<Picture<T>, Problem> {
        fresh(self.newest.borrow().clone())
    }

    /// The first picture whose sequence is not `after`, waiting up to `patience` for it.
    ///
    /// Not "greater than": a camera that starts anew counts from the beginning.
    ///
    /// # Errors
    /// 503 when none came in that time.
    pub async fn after(&self, after: u64, patience: Duration) -> Result<Picture<T>, Problem> {
        let mut newest = self.newest.subscribe();
        let is_new = |picture: &Option<Picture<T>>| {
            picture.as_ref().is_some_and(|picture| picture.sequence != after && picture.age() <= STALE_AFTER)
        };
        match tokio::time::timeout(patience, newest.wait_for(is_new)).await {
            Ok(Ok(picture)) => fresh(picture.clone()),
            // The sender lives in `self`, so the channel cannot close while this waits: only time ran out.
            Ok(Err(_)) | Err(_) => self.latest().and(Err(no_newer(after))),
        }
    }

    pub(crate) fn subscribe(&self) -> watch::Receiver<Option<Picture<T>>> {
        self.newest.subscribe()
    }
}

fn no_newer(after: u64) -> Problem {
    Problem::unavailable(format!("no picture newer than {after} arrived"), Duration::from_secs(1))
}

fn fresh<T>(picture: Option<Picture<T>>) -> Result<Picture<T>, Problem> {
    let retry = Duration::from_secs(1);
    let picture = picture.ok_or_else(|| Problem::unavailable("no picture has arrived yet", retry))?;
    let age = picture.age();
    if age <= STALE_AFTER {
        return Ok(picture);
    }
    let age_ms = u64::try_from(age.as_millis()).unwrap_or(u64::MAX);
    let detail = format!("the newest picture is {:.1} s old; the camera has stopped", age.as_secs_f64());
    Err(Problem::unavailable(detail, retry).with("age_ms", age_ms).with("sequence", picture.sequence))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(sequence: u64) -> Picture<u8> {
        Picture { sequence, captured_at_ns: 5, received_at: Instant::now(), source: Arc::new(0) }
    }

    #[tokio::test(start_paused = true)]
    async fn an_old_picture_is_refused_with_its_age() {
        let feed = PictureFeed::default();
        assert!(feed.latest().is_err());
        feed.publish(picture(7));
        assert_eq!(feed.latest().unwrap().sequence, 7);
        tokio::time::advance(Duration::from_millis(2500)).await;
        let problem = feed.latest().unwrap_err().to_json();
        assert_eq!((problem["status"].as_u64(), problem["age_ms"].as_u64()), (Some(503), Some(2500)));
    }

    #[tokio::test(start_paused = true)]
    async fn a_viewer_waits_for_the_next_picture() {
        let feed = PictureFeed::default();
        feed.publish(picture(7));
        let (next, ()) =
            tokio::join!(feed.after(7, Duration::from_secs(5)), async { feed.publish(picture(8)) });
        assert_eq!(next.unwrap().sequence, 8);
        assert!(feed.after(8, Duration::from_secs(1)).await.is_err());
    }

    #[tokio::test(start_paused = true)]
    async fn a_camera_that_counts_anew_is_seen() {
        let feed = PictureFeed::default();
        feed.publish(picture(1));
        assert_eq!(feed.after(900, Duration::from_secs(1)).await.unwrap().sequence, 1);
    }
}
