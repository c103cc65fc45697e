//! The landmark set in the recording: every file holds the set in force at its head, and each change as it comes.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::{Duration, Instant};

use bytes::Bytes;
use ingest::recorded::{LANDMARKS_ATTACHMENT, SUPERSEDED_ATTACHMENT};
use prost::Message;
use recording::{Attachment, Journal, Latch, LatchKey};
use tokio::sync::watch;
use vision::{Digest, Landmark, LandmarkSet};
use waymark_proto::convert;
use waymark_proto::json::{self, LandmarkFileError};

use crate::tap::{Entry, now_ns};
use crate::topics::VehicleTopics;

/// How long a picture may be on its way to the one who looks at it.
const IN_FLIGHT: Duration = Duration::from_secs(10);
/// Superseded landmarks that are kept at most.
const MOST_SUPERSEDED: usize = 256;

/// Writes the set into the journal as it changes, and hands it on to those who look for it: what is looked for in a
/// picture stands in the recording before what was seen.
pub(crate) struct LandmarkLog {
    journal: Arc<Journal>,
    topics: VehicleTopics,
    written: BTreeMap<String, Digest>,
    changes: u64,
    /// Landmarks that are no longer in force, and since when: a camera may be looking for them in the first pictures of
    /// a file that begins with others.
    superseded: VecDeque<(Instant, Arc<Landmark>)>,
    in_force: watch::Sender<Arc<LandmarkSet>>,
}

impl LandmarkLog {
    /// Writes the first set.
    pub(crate) fn begin(journal: Arc<Journal>, topics: VehicleTopics, first: &Arc<LandmarkSet>) -> Self {
        let in_force = watch::Sender::new(Arc::clone(first));
        let mut log = Self {
            journal,
            topics,
            written: BTreeMap::new(),
            changes: 0,
            superseded: VecDeque::new(),
            in_force,
        };
        log.write(first);
        log
    }

    /// The set to look for, now and as it changes.
    pub(crate) fn in_force(&self) -> watch::Receiver<Arc<LandmarkSet>> {
        self.in_force.subscribe()
    }

    /// Writes and hands on every further set until its owner is gone.
    pub(crate) async fn run(mut self, mut accepted: watch::Receiver<Arc<LandmarkSet>>) {
        loop {
            let set = Arc::clone(&accepted.borrow_and_update());
            if *self.in_force.borrow() != set {
                self.supersede(&set, Instant::now());
                self.write(&set);
                self.in_force.send_replace(set);
            }
            if accepted.changed().await.is_err() {
                return;
            }
        }
    }

    fn write(&mut self, set: &LandmarkSet) {
        self.changes += 1;
        self.forget_retired(set);
        let mut messages = Vec::new();
        for landmark in &set.landmarks {
            if self.written.get(&landmark.id) != Some(&landmark.digest) {
                let message = convert::landmark_to_wire(landmark, set.version.epoch);
                messages.push(self.latched(&self.topics.landmark, latch_key(&landmark.id), &message));
                self.written.insert(landmark.id.clone(), landmark.digest);
            }
        }
        let manifest = convert::manifest_of(set);
        messages.push(self.latched(&self.topics.manifest, LatchKey("manifest".to_owned()), &manifest));
        // Together, so that no file ends between the landmarks and what counts them.
        let _counted_by_the_journal = self.journal.offer_all(messages);
        self.attach(LANDMARKS_ATTACHMENT, json::set_to_json(set));
    }

    /// Takes note of what `set` replaces, and attaches it.
    fn supersede(&mut self, set: &LandmarkSet, now: Instant) {
        let replaced = Arc::clone(&self.in_force.borrow());
        let stays = |old: &Arc<Landmark>| set.landmarks.iter().any(|landmark| landmark.digest == old.digest);
        let gone = replaced.landmarks.iter().filter(|landmark| !stays(landmark));
        let had_some = !self.superseded.is_empty();
        self.superseded.extend(gone.map(|landmark| (now, Arc::clone(landmark))));
        let surplus = self.superseded.len().saturating_sub(MOST_SUPERSEDED);
        self.superseded.drain(..surplus);
        self.superseded.retain(|(since, _)| now.saturating_duration_since(*since) < IN_FLIGHT);
        if had_some || !self.superseded.is_empty() {
            let landmarks = self.superseded.iter().map(|(_, landmark)| landmark.as_ref());
            self.attach(SUPERSEDED_ATTACHMENT, json::landmarks_to_json(landmarks));
        }
    }

    fn attach(&self, name: &str, text: Result<String, LandmarkFileError>) {
        let data = match text {
            Ok(text) => Bytes::from(text),
            Err(error) => return tracing::error!(%error, "landmarks could not be written as JSON"),
        };
        let (name, media_type) = (name.to_owned(), "application/json".to_owned());
        let attachment = Attachment { name, media_type, log_time_ns: now_ns(), data };
        let _counted_by_the_journal = self.journal.attach(attachment);
    }

    fn forget_retired(&mut self, set: &LandmarkSet) {
        let is_there = |id: &String| set.landmarks.iter().any(|landmark| landmark.id == *id);
        for id in self.written.keys().filter(|id| !is_there(id)) {
            let _counted_by_the_journal = self.journal.forget(latch_key(id));
        }
        self.written.retain(|id, _| is_there(id));
    }

    fn latched(
        &self,
        channel: &Arc<recording::ChannelSpec>,
        key: LatchKey,
        message: &impl Message,
    ) -> recording::Message {
        let data = Bytes::from(message.encode_to_vec());
        let captured_at_ns = i64::try_from(now_ns()).unwrap_or(i64::MAX);
        Entry { channel, captured_at_ns, sequence: self.changes, data, latch: Latch::Repeat(key) }.stamped()
    }
}

fn latch_key(landmark: &str) -> LatchKey {
    LatchKey(format!("landmark/{landmark}"))
}

#[cfg(test)]
mod tests {
    use ingest::recorded::{RecordedItem, RecordedItems};
    use recording::{Command, JournalOptions};
    use vision::SetVersion;
    use waymark_proto::keys::VehicleKeys;

    use super::*;
    use crate::accepted::tests::landmark;

    fn set(version: u64, landmarks: &[&Arc<Landmark>]) -> Arc<LandmarkSet> {
        let landmarks = landmarks.iter().map(|landmark| Arc::clone(landmark)).collect();
        Arc::new(LandmarkSet { version: SetVersion { epoch: 1, version }, landmarks })
    }

    #[tokio::test]
    async fn a_file_has_what_is_looked_for_and_what_was_until_a_moment_before() {
        let directory = tempfile::tempdir().unwrap();
        let journal = Arc::new(Journal::start(JournalOptions::new(directory.path(), "car")).unwrap());
        let keys = |vehicle| VehicleKeys::new("convoy", vehicle).unwrap();
        let topics = VehicleTopics::new(&keys("car"), &keys("lead"));
        let (blue, red) = (Arc::new(landmark("blue", 1, 40.0)), Arc::new(landmark("red", 1, 200.0)));
        let (first, second) = (set(1, &[&blue, &red]), set(2, &[&blue]));
        let (leader, accepted) = watch::channel(Arc::clone(&first));
        let log = LandmarkLog::begin(Arc::clone(&journal), topics, &first);
        let mut in_force = log.in_force();
        let running = tokio::spawn(log.run(accepted));
        leader.send_replace(Arc::clone(&second));
        in_force.wait_for(|set| *set == second).await.unwrap();
        // Whoever looks for the second set now looks for what is in the journal already.
        journal.command(Command::Split);
        drop(leader);
        running.await.unwrap();
        assert!(journal.finish(Duration::from_secs(30)).in_time);

        let mut files: Vec<_> =
            std::fs::read_dir(directory.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        let read = |file| RecordedItems::open(file).unwrap().map(Result::unwrap).collect::<Vec<_>>();
        let of_first = read(&files[0]);
        let sets = of_first.iter().filter_map(|item| match item {
            RecordedItem::Landmarks(set) => Some(set.version.version),
            _ => None,
        });
        assert_eq!(sets.collect::<Vec<_>>(), [1, 2]);
        let of_second = read(&files[1]);
        let in_force = |item: &RecordedItem| matches!(item, RecordedItem::Landmarks(set) if *set == *second);
        let superseded = |item: &RecordedItem| matches!(item, RecordedItem::Superseded(gone) if gone[..] == [(*red).clone()]);
        assert!(of_second.iter().any(in_force) && of_second.iter().any(superseded), "{of_second:?}");
    }
}
