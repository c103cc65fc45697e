//! What a recording says was seen live, handed out frame by frame.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ingest::recorded::{RecordedItem, RecordedItems, camera_of};
use recording::RecordingError;
use vision::{Outcome, Timestamp};

/// Reads the recorded results of a recording in step with its frames: a result stands behind its picture, by as much as
/// the camera's thread was late. Holds only what is read and not yet asked for.
pub struct RecordedOutcomes {
    items: RecordedItems,
    /// The one camera that was asked for.
    camera: Option<Arc<str>>,
    ahead: BTreeMap<Arc<str>, BTreeMap<(Timestamp, u32), Outcome>>,
}

impl RecordedOutcomes {
    /// Opens a recording, with the one image topic that is of interest if not all are.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn open(file: &Path, topic: Option<&str>) -> Result<Self, RecordingError> {
        let items = RecordedItems::open(file)?;
        Ok(Self { items, camera: topic.map(camera_of), ahead: BTreeMap::new() })
    }

    /// The result of one frame, of whose sequence number the low half counts, as recordings have no more of a picture's;
    /// results of the same camera's earlier frames are forgotten.
    ///
    /// # Errors
    /// When the recording cannot be read any further.
    pub fn take(
        &mut self,
        camera: &str,
        captured_at: Timestamp,
        sequence: u64,
    ) -> Result<Option<Outcome>, RecordingError> {
        let key = (captured_at, sequence as u32);
        loop {
            if let Some(ahead) = self.ahead.get_mut(camera) {
                let mut later = ahead.split_off(&key);
                let found = later.remove(&key);
                let passed = !later.is_empty();
                *ahead = later;
                if found.is_some() || passed {
                    return Ok(found);
                }
            }
            match self.items.next().transpose()? {
                None => return Ok(None),
                Some(RecordedItem::Registration { camera, outcome, .. })
                    if self.camera.as_ref().is_none_or(|wanted| *wanted == camera) =>
                {
                    let key = (outcome.captured_at, outcome.sequence as u32);
                    self.ahead.entry(camera).or_default().insert(key, outcome);
                }
                Some(_) => {}
            }
        }
    }
}
