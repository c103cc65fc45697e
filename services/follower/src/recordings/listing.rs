//! What there is, told without reading more than each file's summary.

use std::io;

use recording::summary::Summary;
use schemars::JsonSchema;
use serde::Serialize;

use super::topics::cameras;
use super::{Found, Shelf};

/// Recordings, newest first.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Recordings {
    /// At most as many as were asked for.
    pub(super) recordings: Vec<RecordingEntry>,
    /// For `after`, when there are more.
    pub(super) next: Option<String>,
}

/// One recording. What only its summary tells is missing until it is finished.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct RecordingEntry {
    /// Its name, now and when it is finished.
    name: String,
    /// The vehicle that recorded it.
    vehicle: String,
    /// When it was begun, UTC, `YYYYMMDDTHHMMSSZ`.
    started_at: String,
    /// `finished`, or `unfinished` while it is being written or when its writer died.
    state: &'static str,
    /// Its size so far.
    bytes: u64,
    /// From its first message to its last.
    duration_s: Option<f64>,
    /// On all topics.
    messages: Option<u64>,
    /// Cameras whose pictures it holds.
    cameras: Vec<RecordedCamera>,
}

/// A camera of a recording.
#[derive(Debug, Serialize, JsonSchema)]
struct RecordedCamera {
    /// Its id.
    id: String,
    /// Pictures.
    frames: u64,
    /// Pictures that were registered live.
    registrations: u64,
}

impl Shelf {
    /// Up to `limit` recordings behind the one called `after`.
    pub(super) fn list(&self, after: Option<&str>, limit: usize) -> io::Result<Recordings> {
        let all = self.all()?;
        // A recording that was deleted meanwhile is no place to go on from: begin anew.
        let behind = after.and_then(|after| all.iter().position(|found| found.name.finished() == after));
        let mut rest = all.iter().skip(behind.map_or(0, |at| at + 1));
        let recordings: Vec<_> = rest.by_ref().take(limit).map(entry).collect();
        let next = rest.next().and(recordings.last()).map(|last| last.name.clone());
        Ok(Recordings { recordings, next })
    }
}

fn entry(found: &Found) -> RecordingEntry {
    // A file without a summary, or with a damaged one, is listed with what its name tells.
    let summary = Summary::read(&found.path).ok().flatten();
    let counts = summary.as_ref().map(Summary::messages_by_topic).unwrap_or_default();
    let frames_of = |topic: &str| counts.get(topic).copied().unwrap_or(0);
    let span = summary.as_ref().and_then(Summary::log_span_ns);
    RecordingEntry {
        name: found.name.finished(),
        vehicle: found.name.vehicle.clone(),
        started_at: found.name.utc.clone(),
        state: if found.is_finished { "finished" } else { "unfinished" },
        bytes: found.bytes,
        duration_s: span.map(|(first, last)| last.saturating_sub(first) as f64 * 1e-9),
        messages: summary.as_ref().map(|_| counts.values().sum()),
        cameras: cameras(counts.keys().copied())
            .into_iter()
            .map(|topics| RecordedCamera {
                frames: frames_of(&topics.image),
                registrations: frames_of(&topics.registration),
                id: topics.camera,
            })
            .collect(),
    }
}
