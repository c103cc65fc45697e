//! The landmark set in the recording: every file holds the set in force at its head, and each change as it comes.

use std::collections::BTreeMap;
use std::sync::Arc;

use bytes::Bytes;
use ingest::recorded::LANDMARKS_ATTACHMENT;
use prost::Message;
use recording::{Attachment, Journal, Latch, LatchKey};
use tokio::sync::watch;
use vision::{Digest, LandmarkSet};
use waymark_proto::{convert, json};

use crate::tap::{Entry, now_ns, offer};
use crate::topics::VehicleTopics;

/// Writes the set into the journal as it changes.
pub(crate) struct LandmarkLog {
    journal: Arc<Journal>,
    topics: VehicleTopics,
    written: BTreeMap<String, Digest>,
    changes: u64,
}

impl LandmarkLog {
    pub(crate) fn new(journal: Arc<Journal>, topics: VehicleTopics) -> Self {
        Self { journal, topics, written: BTreeMap::new(), changes: 0 }
    }

    /// Writes every state of the set until its owner is gone.
    pub(crate) async fn run(mut self, mut landmarks: watch::Receiver<Arc<LandmarkSet>>) {
        loop {
            let set = Arc::clone(&landmarks.borrow_and_update());
            self.write(&set);
            if landmarks.changed().await.is_err() {
                return;
            }
        }
    }

    fn write(&mut self, set: &LandmarkSet) {
        self.changes += 1;
        self.forget_retired(set);
        for landmark in &set.landmarks {
            if self.written.get(&landmark.id) != Some(&landmark.digest) {
                let message = convert::landmark_to_wire(landmark, set.version.epoch);
                self.latch(&self.topics.landmark, latch_key(&landmark.id), &message);
                self.written.insert(landmark.id.clone(), landmark.digest);
            }
        }
        self.latch(&self.topics.manifest, LatchKey("manifest".to_owned()), &convert::manifest_of(set));
        let data = match json::set_to_json(set) {
            Ok(text) => Bytes::from(text),
            Err(error) => return tracing::error!(%error, "the landmark set could not be written as JSON"),
        };
        let media_type = "application/json".to_owned();
        let attachment =
            Attachment { name: LANDMARKS_ATTACHMENT.to_owned(), media_type, log_time_ns: now_ns(), data };
        let _counted_by_the_journal = self.journal.attach(attachment);
    }

    fn forget_retired(&mut self, set: &LandmarkSet) {
        let is_there = |id: &String| set.landmarks.iter().any(|landmark| landmark.id == *id);
        for id in self.written.keys().filter(|id| !is_there(id)) {
            let _counted_by_the_journal = self.journal.forget(latch_key(id));
        }
        self.written.retain(|id, _| is_there(id));
    }

    fn latch(&self, channel: &Arc<recording::ChannelSpec>, key: LatchKey, message: &impl Message) {
        let data = Bytes::from(message.encode_to_vec());
        let captured_at_ns = i64::try_from(now_ns()).unwrap_or(i64::MAX);
        let latch = Latch::Repeat(key);
        offer(&self.journal, Entry { channel, captured_at_ns, sequence: self.changes, data, latch });
    }
}

fn latch_key(landmark: &str) -> LatchKey {
    LatchKey(format!("landmark/{landmark}"))
}
