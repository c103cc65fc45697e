//! A recording as the frames of its cameras, each with the landmarks that were looked for in it when it was captured.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ingest::encoded::EncodedFrame;
use ingest::picture_message::NoPicture;
use ingest::recorded::{RecordedItem, RecordedItems};
use recording::RecordingError;
use vision::{LandmarkSet, SetVersion};

use super::{FrameError, InputError, InputFrame, Live};

/// What a first reading of the recording found out.
#[derive(Debug, Default)]
struct Survey {
    /// Pictures on each image topic.
    pictures: BTreeMap<String, usize>,
    /// For each camera of which results were recorded: full sequence number and set of each registered picture, by its
    /// sequence number cut to 32 bits.
    registered: BTreeMap<Arc<str>, BTreeMap<u32, (u64, SetVersion)>>,
    /// Every set that was in force at some time.
    sets: BTreeMap<SetVersion, Arc<LandmarkSet>>,
}

/// The pictures of a recording's cameras in the order of the file.
pub struct Replay {
    items: RecordedItems,
    survey: Survey,
    /// The one topic that was asked for.
    topic: Option<String>,
    in_force: Option<Arc<LandmarkSet>>,
    /// Pictures so far, by camera.
    counts: BTreeMap<Arc<str>, u64>,
    remaining: usize,
}

impl Replay {
    pub(super) fn open(given: &str, file: &Path, topic: Option<&str>) -> Result<Self, InputError> {
        let survey = survey(file)?;
        let wanted = |name: &str| topic.is_none_or(|topic| topic == name);
        let counts = survey.pictures.iter().filter(|(name, _)| wanted(name));
        let remaining = counts.map(|(_, count)| count).sum();
        let topic = topic.map(str::to_owned);
        if remaining == 0 {
            let topics = survey.pictures.into_keys().collect();
            return Err(InputError::NoImages { given: given.to_owned(), topic, topics });
        }
        let items = RecordedItems::open(file)?;
        Ok(Self { items, survey, topic, in_force: None, counts: BTreeMap::new(), remaining })
    }

    pub(super) fn brings_landmarks(&self) -> bool {
        !self.survey.sets.is_empty()
    }

    fn frame(&mut self, camera: Arc<str>, picture: Result<EncodedFrame, NoPicture>) -> InputFrame {
        self.remaining = self.remaining.saturating_sub(1);
        let count = self.counts.entry(Arc::clone(&camera)).or_default();
        *count += 1;
        let (frame, name) =
            (*count, format!("{}, camera {camera}, frame {count}", self.items.path().display()));
        let (picture, live) = match picture {
            Err(error) => (Err(error.into()), Live::Unknown),
            Ok(mut picture) => {
                let live = self.live(&camera, &mut picture.sequence);
                (Ok(picture), live)
            }
        };
        InputFrame { frame, camera: Some(camera), name, picture, live }
    }

    /// What became of a picture, whose sequence number is made whole where the recording tells it.
    fn live(&self, camera: &Arc<str>, sequence: &mut u64) -> Live {
        let in_force = || self.in_force.clone().map_or(Live::Unknown, Live::Registered);
        let Some(registered) = self.survey.registered.get(camera) else { return in_force() };
        let Some((whole, version)) = registered.get(&(*sequence as u32)) else { return Live::Dropped };
        *sequence = *whole;
        self.survey.sets.get(version).cloned().map_or_else(in_force, Live::Registered)
    }

    fn lost(&self, reason: FrameError) -> InputFrame {
        let name = self.items.path().display().to_string();
        InputFrame { frame: 0, camera: None, name, picture: Err(reason), live: Live::Unknown }
    }
}

impl Iterator for Replay {
    type Item = InputFrame;

    fn next(&mut self) -> Option<InputFrame> {
        loop {
            match self.items.next()? {
                Ok(RecordedItem::Picture { topic, camera, picture }) => {
                    if self.topic.as_ref().is_none_or(|wanted| *wanted == topic) {
                        return Some(self.frame(camera, picture));
                    }
                }
                Ok(RecordedItem::Landmarks(set)) => self.in_force = Some(Arc::new(set)),
                Ok(RecordedItem::Registration { .. }) => {}
                Ok(RecordedItem::Damage(damage)) => return Some(self.lost(damage.into())),
                Err(error) => return Some(self.lost(error.into())),
            }
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.remaining, None)
    }
}

fn survey(file: &Path) -> Result<Survey, RecordingError> {
    let mut survey = Survey::default();
    for item in RecordedItems::open(file)? {
        match item? {
            RecordedItem::Picture { topic, .. } => *survey.pictures.entry(topic).or_default() += 1,
            RecordedItem::Landmarks(set) => {
                survey.sets.insert(set.version, Arc::new(set));
            }
            RecordedItem::Registration { camera, outcome } => {
                let registered = survey.registered.entry(camera).or_default();
                registered.insert(outcome.sequence as u32, (outcome.sequence, outcome.set_version));
            }
            // Told when the frames themselves are read.
            RecordedItem::Damage(_) => {}
        }
    }
    Ok(survey)
}
