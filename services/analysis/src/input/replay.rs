//! A recording as the frames of its cameras, each with the landmarks that were looked for in it when it was captured.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ingest::encoded::EncodedFrame;
use ingest::picture_message::NoPicture;
use ingest::recorded::{RecordedItem, RecordedItems};
use recording::RecordingError;
use vision::follow::FollowState;
use vision::{Landmark, LandmarkSet, Outcome, Pinhole, SetVersion, Timestamp};
use waymark_proto::convert::FollowSnapshot;
use waymark_proto::digest::set_digest;

use super::{FrameError, InputError, InputFrame, Live, Past};

/// Full sequence number and set of pictures, by their capture time and their sequence number cut to 32 bits.
type RegisteredPictures = BTreeMap<(Timestamp, u32), (u64, SetKey)>;

/// What tells one set from another: its version, and a digest over those of its landmarks. Between a changed landmark and
/// the manifest that counts the change, two sets go under one version.
type SetKey = (SetVersion, [u8; 32]);

/// What a first reading of the recording found out.
#[derive(Debug, Default)]
struct Survey {
    /// Pictures on each image topic.
    pictures: BTreeMap<String, usize>,
    /// What was looked at, for each camera of which results were recorded.
    registered: BTreeMap<Arc<str>, RegisteredPictures>,
    /// Whether the recording says what was in force.
    brings_landmarks: bool,
    /// Every set that was looked for and whose landmarks are all there.
    sets: BTreeMap<SetKey, Arc<LandmarkSet>>,
    /// Calibrated cameras, as their first calibration says; a later one counts from where it stands in the file.
    pinholes: BTreeMap<Arc<str>, Pinhole>,
    /// Where each camera stood, by the capture time of the last picture it had looked at.
    states: BTreeMap<String, BTreeMap<Timestamp, FollowSnapshot>>,
}

/// How far a camera's results rest on pictures that are there.
#[derive(Debug, Default)]
struct Footing {
    /// The last picture that counts: looked at, or included in the last state.
    at: Option<Timestamp>,
    /// Whether one is missing since the last state.
    gap: bool,
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
    footings: BTreeMap<Arc<str>, Footing>,
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
        let (counts, footings) = (BTreeMap::new(), BTreeMap::new());
        Ok(Self { items, survey, topic, in_force: None, counts, footings, remaining })
    }

    pub(super) fn brings_landmarks(&self) -> bool {
        self.survey.brings_landmarks
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
                let live = self.live(&camera, &mut picture);
                (Ok(picture), live)
            }
        };
        let pinhole = self.survey.pinholes.get(&camera).copied();
        InputFrame { frame, camera: Some(camera), name, picture, live, pinhole }
    }

    /// What became of a picture, whose sequence number is made whole where the recording tells it.
    fn live(&mut self, camera: &Arc<str>, picture: &mut EncodedFrame) -> Live {
        let in_force = self.in_force.clone();
        let looked_for = match self.survey.registered.get(camera) {
            None => in_force,
            Some(registered) => {
                let frame = (picture.captured_at, picture.sequence as u32);
                let Some((whole, set)) = registered.get(&frame) else { return Live::Dropped };
                picture.sequence = *whole;
                self.survey.sets.get(set).cloned().or(in_force)
            }
        };
        match looked_for {
            None => Live::Unknown,
            Some(landmarks) => {
                let snapshot = self.survey.state_before(camera, picture.captured_at);
                let (options, state) = snapshot.map(|snapshot| (snapshot.options, snapshot.state)).unzip();
                let result = self.past(camera, picture.captured_at, state.as_ref());
                Live::Registered { landmarks, options, state, result }
            }
        }
    }

    /// What the result of a camera's picture rests on, `state` being one that is recorded anew before it.
    fn past(
        &mut self,
        camera: &Arc<str>,
        captured_at: Timestamp,
        state: Option<&FollowState>,
    ) -> Option<Past> {
        let registered = self.survey.registered.get(camera)?;
        let footing = self.footings.entry(Arc::clone(camera)).or_default();
        if let Some(last) = state.and_then(|state| state.last) {
            *footing = Footing { at: Some(last.captured_at), gap: false };
        }
        let before = registered.range(..(captured_at, 0)).next_back();
        footing.gap |= before.is_some_and(|((before, _), _)| footing.at.is_none_or(|at| *before > at));
        footing.at = Some(captured_at);
        Some(if footing.gap { Past::Missing } else { Past::Whole })
    }

    fn lost(&self, reason: FrameError) -> InputFrame {
        let name = self.items.path().display().to_string();
        InputFrame { frame: 0, camera: None, name, picture: Err(reason), live: Live::Unknown, pinhole: None }
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
                Ok(RecordedItem::Calibration { camera, pinhole: Some(pinhole) }) => {
                    self.survey.pinholes.insert(camera, pinhole);
                }
                Ok(
                    RecordedItem::Registration { .. }
                    | RecordedItem::Superseded(_)
                    | RecordedItem::State(_)
                    | RecordedItem::Truth { .. }
                    | RecordedItem::Calibration { pinhole: None, .. },
                ) => {}
                Ok(RecordedItem::Damage(damage)) => return Some(self.lost(damage.into())),
                Err(error) => return Some(self.lost(error.into())),
            }
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.remaining, None)
    }
}

impl Survey {
    /// Takes out the newest state that holds before a picture captured at `captured_at`, and those before it.
    fn state_before(&mut self, camera: &str, captured_at: Timestamp) -> Option<FollowSnapshot> {
        let states = self.states.get_mut(camera)?;
        let later = states.split_off(&captured_at);
        std::mem::replace(states, later).into_values().next_back()
    }
}

fn survey(file: &Path) -> Result<Survey, RecordingError> {
    let mut survey = Survey::default();
    let mut descriptors = Descriptors::default();
    for item in RecordedItems::open(file)? {
        match item? {
            RecordedItem::Picture { topic, .. } => *survey.pictures.entry(topic).or_default() += 1,
            RecordedItem::Landmarks(set) => {
                survey.brings_landmarks = true;
                descriptors.know(set.landmarks);
            }
            RecordedItem::Superseded(landmarks) => descriptors.know(landmarks.into_iter().map(Arc::new)),
            RecordedItem::Registration { camera, outcome, .. } => {
                let registered = survey.registered.entry(camera).or_default();
                let frame = (outcome.captured_at, outcome.sequence as u32);
                registered.insert(frame, (outcome.sequence, descriptors.looked_for(&outcome)));
            }
            RecordedItem::State(snapshot) => {
                if let Some(last) = snapshot.state.last {
                    let states = survey.states.entry(snapshot.camera.to_string()).or_default();
                    states.insert(last.captured_at, snapshot);
                }
            }
            RecordedItem::Calibration { camera, pinhole: Some(pinhole) } => {
                survey.pinholes.entry(camera).or_insert(pinhole);
            }
            // Damage is told when the frames themselves are read.
            RecordedItem::Damage(_)
            | RecordedItem::Truth { .. }
            | RecordedItem::Calibration { pinhole: None, .. } => {}
        }
    }
    survey.sets = descriptors.sets();
    Ok(survey)
}

/// The landmarks of a recording, and which of them were looked for together.
#[derive(Debug, Default)]
struct Descriptors {
    known: BTreeMap<[u8; 32], Arc<Landmark>>,
    looked_for: BTreeMap<SetKey, Vec<[u8; 32]>>,
}

impl Descriptors {
    fn know(&mut self, landmarks: impl IntoIterator<Item = Arc<Landmark>>) {
        self.known.extend(landmarks.into_iter().map(|landmark| (landmark.digest.0, landmark)));
    }

    /// The set of an outcome, which has an entry for each landmark of it, and one more for each further instance.
    fn looked_for(&mut self, outcome: &Outcome) -> SetKey {
        let instances = outcome.landmarks.chunk_by(|one, next| one.landmark == next.landmark);
        let digests = || instances.clone().map(|instances| instances[0].digest);
        let key = (outcome.set_version, set_digest(digests()).0);
        self.looked_for.entry(key).or_insert_with(|| digests().map(|digest| digest.0).collect());
        key
    }

    fn sets(self) -> BTreeMap<SetKey, Arc<LandmarkSet>> {
        let Self { known, looked_for } = self;
        let set = |(key, digests): (SetKey, Vec<[u8; 32]>)| {
            let landmarks: Option<Vec<_>> = digests.iter().map(|digest| known.get(digest).cloned()).collect();
            let (version, _) = key;
            Some((key, Arc::new(LandmarkSet { version, landmarks: landmarks? })))
        };
        looked_for.into_iter().filter_map(set).collect()
    }
}
