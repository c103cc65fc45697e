//! What a recording says of each camera's drive: its pictures, what was registered in them, and what was true.
//!
//! Outlines and segments are left out, so that an hour of driving fits into memory.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ingest::recorded::{RecordedItem, RecordedItems};
use recording::RecordingError;
use vision::{Outcome, Timestamp};
use waymark_proto::v1;

/// All cameras of a recording.
#[derive(Clone, Debug, Default)]
pub struct Drive {
    /// By camera.
    pub cameras: BTreeMap<Arc<str>, CameraDrive>,
    /// Parts of the file that could not be used, in words.
    pub damage: Vec<String>,
}

/// One camera's drive, frame by frame in the order of capture.
#[derive(Clone, Debug, Default)]
pub struct CameraDrive {
    /// Pictures in the recording, those included that cannot be used.
    pub pictures: u64,
    /// Everything that was said of a frame, by capture time and the low half of its sequence number.
    pub frames: BTreeMap<(Timestamp, u32), DriveFrame>,
}

/// What is known of one frame.
#[derive(Clone, Debug, Default)]
pub struct DriveFrame {
    /// Which picture of its camera, counted from 1; `None` when the picture is not in the recording.
    pub number: Option<u64>,
    /// What was seen, if somebody looked.
    pub outcome: Option<Outcome>,
    /// What a simulator really showed.
    pub truth: Option<v1::Truth>,
}

impl Drive {
    /// Reads a recording, whether finished or cut.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let mut drive = Self::default();
        for item in RecordedItems::open(path)? {
            drive.add(item?);
        }
        Ok(drive)
    }

    fn add(&mut self, item: RecordedItem) {
        match item {
            RecordedItem::Picture { camera, picture, .. } => {
                let camera = self.cameras.entry(camera).or_default();
                camera.pictures += 1;
                let number = camera.pictures;
                match picture {
                    Ok(picture) => {
                        camera.frame(picture.captured_at, picture.sequence).number = Some(number);
                    }
                    Err(error) => self.damage.push(error.to_string()),
                }
            }
            RecordedItem::Registration { camera, outcome, .. } => {
                let camera = self.cameras.entry(camera).or_default();
                let frame = camera.frame(outcome.captured_at, outcome.sequence);
                frame.outcome = Some(without_outlines(outcome));
            }
            RecordedItem::Truth { camera, truth } => {
                let camera = self.cameras.entry(camera).or_default();
                let captured_at = Timestamp::from_nanos(truth.captured_at_ns);
                let frame = camera.frame(captured_at, truth.sequence);
                frame.truth = Some(truth);
            }
            RecordedItem::Damage(damage) => self.damage.push(damage.to_string()),
            RecordedItem::Landmarks(_)
            | RecordedItem::Superseded(_)
            | RecordedItem::State(_)
            | RecordedItem::Calibration { .. } => {}
        }
    }
}

impl CameraDrive {
    /// Frames that were looked at, in the order of capture.
    pub fn registered(&self) -> impl Iterator<Item = (&DriveFrame, &Outcome)> {
        self.frames.values().filter_map(|frame| Some((frame, frame.outcome.as_ref()?)))
    }

    fn frame(&mut self, captured_at: Timestamp, sequence: u64) -> &mut DriveFrame {
        self.frames.entry((captured_at, sequence as u32)).or_default()
    }
}

fn without_outlines(mut outcome: Outcome) -> Outcome {
    for landmark in &mut outcome.landmarks {
        if let Ok(sighting) = &mut landmark.result {
            (sighting.outline, sighting.segments) = (Vec::new(), Vec::new());
        }
    }
    outcome
}
