//! The landmarks that a recording was made with: its own, whatever is in force now.

use std::sync::Arc;

use recording::RecordingError;
use recording::timeline::Timeline;
use schemars::JsonSchema;
use serde::Serialize;
use vision::Landmark;
use waymark_proto::convert::landmark_from_wire;
use waymark_proto::documents::LandmarkDocument;
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;

use super::{Found, topics};

/// Descriptors of a recording; a registration names the one it looked for by its digest.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct RecordedLandmarks {
    /// Each one once, in the order of the file; one that was changed is another one.
    landmarks: Vec<LandmarkDocument>,
}

impl RecordedLandmarks {
    pub(super) fn of(landmarks: &[Arc<Landmark>]) -> Self {
        Self { landmarks: landmarks.iter().map(|landmark| landmark.as_ref().into()).collect() }
    }
}

/// Reads them. One that is damaged is left out: it was not looked for.
pub(super) fn landmarks(found: &Found, timeline: &Timeline) -> Result<Vec<Arc<Landmark>>, RecordingError> {
    let mut known: Vec<Arc<Landmark>> = Vec::new();
    for topic in topics::landmarks(timeline.topics()) {
        for message in timeline.messages(&found.path, topic, 0..usize::MAX)? {
            let wire = v1::Landmark::from_payload(&message?.data).ok();
            let Some((landmark, _epoch)) = wire.and_then(|wire| landmark_from_wire(&wire).ok()) else {
                continue;
            };
            if known.iter().all(|known| known.digest != landmark.digest) {
                known.push(Arc::new(landmark));
            }
        }
    }
    Ok(known)
}
