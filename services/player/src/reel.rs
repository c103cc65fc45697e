//! Reads recordings ahead of their times, with the state that was in force where playing begins.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use recording::RecordingError;
use recording::excerpt::{Excerpt, Selection};
use recording::reader::{MessageReader, Strictness};
use recording::summary::Summary;
use recording::walk::{RecordedChannel, RecordedMessage};
use waymark_proto::payload::WireMessage;
use waymark_proto::{foxglove, v1};

/// Messages read ahead.
const READ_AHEAD: usize = 64;

/// A message on its way out.
#[derive(Clone, Debug)]
pub struct PlayedMessage {
    /// The message as recorded.
    pub message: RecordedMessage,
    /// The key it came from.
    pub key: String,
    /// Whether it is state from before the beginning, due at once.
    pub is_state: bool,
}

/// The recordings, in the order of their first messages.
#[derive(Clone, Debug)]
pub(crate) struct Reel {
    files: Vec<PathBuf>,
    /// Log time of the very first message.
    pub(crate) begins_ns: u64,
}

impl Reel {
    /// Looks at the first message of each file.
    pub(crate) fn open(files: &[PathBuf]) -> Result<Option<Self>, RecordingError> {
        let mut begun = Vec::new();
        for file in files {
            if let Some(first) = MessageReader::open(file, Strictness::Lenient)?.next().transpose()? {
                begun.push((first.log_time_ns, file.clone()));
            }
        }
        begun.sort();
        let Some(&(begins_ns, _)) = begun.first() else { return Ok(None) };
        Ok(Some(Self { files: begun.into_iter().map(|(_, file)| file).collect(), begins_ns }))
    }

    /// From the very first message to the very last, as the recordings' summaries have it; `None` where one has none.
    pub(crate) fn duration_ns(&self) -> Option<u64> {
        let mut ends_ns = self.begins_ns;
        for file in &self.files {
            let summary = Summary::read(file).ok()??;
            ends_ns = ends_ns.max(summary.log_span_ns()?.1);
        }
        Some(ends_ns - self.begins_ns)
    }

    /// Reads from `from_ns` on, on a thread of its own, which ends when nobody takes any more.
    pub(crate) fn read_ahead(
        &self,
        from_ns: u64,
    ) -> std::io::Result<Receiver<Result<PlayedMessage, RecordingError>>> {
        let (sender, receiver) = sync_channel(READ_AHEAD);
        let reel = self.clone();
        std::thread::Builder::new().name("read ahead".to_owned()).spawn(move || {
            if let Err(error) = reel.read(from_ns, &sender) {
                // Whoever does not listen any more does not want to know.
                let _ended = sender.send(Err(error));
            }
        })?;
        Ok(receiver)
    }

    fn read(
        &self,
        from_ns: u64,
        sender: &SyncSender<Result<PlayedMessage, RecordingError>>,
    ) -> Result<(), RecordingError> {
        for state in self.state_before(from_ns)? {
            if sender.send(Ok(state)).is_err() {
                return Ok(());
            }
        }
        for file in &self.files {
            for message in excerpt(file, from_ns..u64::MAX)? {
                let Some(played) = played(message?) else { continue };
                if sender.send(Ok(played)).is_err() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The newest of each kind of state before `from_ns`, in the order of their times.
    fn state_before(&self, from_ns: u64) -> Result<Vec<PlayedMessage>, RecordingError> {
        let mut state: BTreeMap<String, PlayedMessage> = BTreeMap::new();
        if from_ns <= self.begins_ns {
            return Ok(Vec::new());
        }
        for file in &self.files {
            for message in excerpt(file, 0..from_ns)? {
                let message = message?;
                if is_state(&message.channel)
                    && let Some(played) = played(message)
                {
                    state.insert(played.key.clone(), PlayedMessage { is_state: true, ..played });
                }
            }
        }
        let mut state: Vec<PlayedMessage> = state.into_values().collect();
        state.sort_by_key(|played| played.message.log_time_ns);
        Ok(state)
    }
}

fn excerpt(file: &Path, log_time_ns: std::ops::Range<u64>) -> Result<Excerpt, RecordingError> {
    Excerpt::open(file, Selection { topics: None, log_time_ns })
}

fn is_state(channel: &Arc<RecordedChannel>) -> bool {
    let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
    [v1::Landmark::SCHEMA, v1::LandmarkManifest::SCHEMA, foxglove::CameraCalibration::SCHEMA]
        .contains(&schema)
}

/// A message with the key it came from; `None` for what was never on a key, such as logs.
fn played(message: RecordedMessage) -> Option<PlayedMessage> {
    let recorded = message.channel.metadata.get("key_expression");
    let key = match recorded.map_or(message.channel.topic.trim_matches('/'), String::as_str) {
        "" => return None,
        // All landmarks share a channel; each has a key of its own.
        key if key.contains('*') => {
            let landmark = v1::Landmark::from_payload(&message.data).ok()?;
            format!("{}/{}", key.trim_end_matches('*').trim_end_matches('/'), landmark.id)
        }
        key => key.to_owned(),
    };
    Some(PlayedMessage { message, key, is_state: false })
}
