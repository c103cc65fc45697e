//! What was seen, page by page.

use ingest::recorded::places_in;
use recording::RecordingError;
use recording::timeline::Timeline;
use recording::walk::RecordedMessage;
use schemars::JsonSchema;
use serde::Serialize;
use vision::{Outcome, Place};
use waymark_proto::convert::registration_from_wire;
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;

use super::Found;
use crate::status::{LandmarkStatus, landmarks_from_outcome};

/// Registrations of one camera, in the order in which they were recorded.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Registrations {
    /// The camera's id.
    pub(super) camera: String,
    /// How many the recording holds.
    pub(super) total: usize,
    /// At most as many as were asked for.
    pub(super) registrations: Vec<RegistrationEntry>,
    /// For `after`, when there are more.
    pub(super) next: Option<String>,
}

/// What one frame said.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct RegistrationEntry {
    /// The frame's number in its stream.
    pub(super) sequence: u64,
    /// When it was captured, ns since the Unix epoch.
    pub(super) captured_at_ns: i64,
    /// What was seen, as in the status of a camera.
    pub(super) landmarks: Vec<LandmarkStatus>,
}

impl From<&Recorded> for RegistrationEntry {
    fn from(Recorded { outcome, places }: &Recorded) -> Self {
        Self {
            sequence: outcome.sequence,
            captured_at_ns: outcome.captured_at.nanos,
            landmarks: landmarks_from_outcome(outcome, places),
        }
    }
}

/// What was said live of one frame.
#[derive(Debug)]
pub(super) struct Recorded {
    pub(super) outcome: Outcome,
    /// Where the landmarks were, in the order of the outcome.
    pub(super) places: Vec<Place>,
}

/// Registrations of `topic` from place `from` on. One that cannot be read is left out: it says nothing.
pub(super) fn page(
    found: &Found,
    timeline: &Timeline,
    camera: String,
    topic: &str,
    from: usize,
    limit: usize,
) -> Result<Registrations, RecordingError> {
    let total = timeline.of(topic).len();
    let end = from.saturating_add(limit);
    let mut registrations = Vec::new();
    for message in timeline.messages(&found.path, topic, from..end)? {
        registrations.extend(recorded_in(&message?).as_ref().map(RegistrationEntry::from));
    }
    let next = (end < total).then(|| end.to_string());
    Ok(Registrations { camera, total, registrations, next })
}

/// What a message says.
pub(super) fn recorded_in(message: &RecordedMessage) -> Option<Recorded> {
    let wire = v1::Registration::from_payload(&message.data).ok()?;
    let (_, outcome) = registration_from_wire(&wire).ok()?;
    Some(Recorded { outcome, places: places_in(&wire) })
}
