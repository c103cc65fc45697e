//! Publishes pictures at their times until the source or the process ends.

use std::time::Duration;

use runtime::Shutdown;
use runtime::identity::unix_time_ns;
use tokio::time::{Instant, sleep_until};
use vision::Timestamp;
use zenoh::Session;

use crate::coder::{Sendable, Sendables};
use crate::config::CameraConfig;
use crate::error::CameraError;
use crate::publishing::Publishing;

/// What a camera leaves behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CameraReport {
    /// Pictures published.
    pub published: u64,
    /// Pictures that were ready only after their time, because reading or rendering them took too long.
    pub late: u64,
}

/// Runs a camera until its source ends or `shutdown`. It never waits for a peer: a picture that cannot be sent is
/// dropped, and its receivers see the gap.
///
/// # Errors
/// When the source cannot be opened or read, or Zenoh refuses a declaration.
pub async fn run(
    config: CameraConfig,
    session: Session,
    shutdown: Shutdown,
) -> Result<CameraReport, CameraError> {
    let mut source = Sendables::open(&config)?;
    let period = period(source.shots.frame_rate_hz().unwrap_or(config.frame_rate_hz))?;
    let publishing = Publishing::declare(&session, &config, source.shots.pinhole()).await?;
    tracing::info!(vehicle = config.vehicle, camera = config.camera, source = config.source, "camera");
    let mut report = CameraReport::default();
    let mut due = Instant::now();
    while !shutdown.is_requested() {
        let next;
        (source, next) = next_picture(source).await?;
        let Some(picture) = next else { break };
        due += picture.since_previous.unwrap_or(period);
        if due < Instant::now() {
            // What is late is published at once, and nothing hurries after it.
            report.late += 1;
            due = Instant::now();
        }
        tokio::select! {
            () = shutdown.requested() => break,
            () = sleep_until(due) => {}
        }
        publishing.publish(picture, Timestamp::from_nanos(unix_time_ns())).await;
        report.published += 1;
    }
    Ok(report)
}

/// Reads, renders or encodes on a thread that may take its time.
async fn next_picture(mut source: Sendables) -> Result<(Sendables, Option<Sendable>), CameraError> {
    let (source, next) = tokio::task::spawn_blocking(move || {
        let next = source.next();
        (source, next)
    })
    .await?;
    Ok((source, next?))
}

pub(crate) fn period(frame_rate_hz: f64) -> Result<Duration, CameraError> {
    if (0.01..=240.0).contains(&frame_rate_hz) {
        return Ok(Duration::from_secs_f64(frame_rate_hz.recip()));
    }
    let value = frame_rate_hz.to_string();
    Err(CameraError::OutOfRange { name: "frame_rate_hz", value, allowed: "0.01 to 240 pictures per second" })
}
