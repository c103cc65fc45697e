//! What a recording holds of its cameras: pictures with their stamps, the landmarks in force, what was registered.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use recording::RecordingError;
use recording::walk::{CutChunk, Fault, RecordedMessage, Step, Walk};
use vision::{Landmark, LandmarkSet, Outcome, Pinhole, Place};
use waymark_proto::convert::{
    FollowSnapshot, InvalidField, follow_state_from_wire, landmark_from_wire, manifest_from_wire,
    registration_from_wire,
};
use waymark_proto::images::pinhole_from_calibration;
use waymark_proto::payload::{RefusedPayload, WireMessage};
use waymark_proto::{foxglove, json, v1};

use crate::encoded::EncodedFrame;
use crate::picture_message::{NoPicture, PictureKind};

/// Name of the attachment that holds the landmark set in force, as JSON.
pub const LANDMARKS_ATTACHMENT: &str = "landmarks.json";

/// Name of the attachment that holds landmarks that were in force until a moment before, as JSON: a camera may still
/// have looked for them in the file's first pictures.
pub const SUPERSEDED_ATTACHMENT: &str = "landmarks.superseded.json";

/// What stands behind `/{vehicle}/camera/{id}/` in the topic of pictures with what was seen drawn into them.
pub const BURNED_IN: &str = "burned_in";

/// What stands behind the topics of results that were found later, in the recording, and not by the follower.
pub const AGAIN: &str = "/again";

/// Something of a recording that concerns its cameras, in the order of the file.
#[derive(Debug)]
pub enum RecordedItem {
    /// A camera's picture.
    Picture {
        /// The topic.
        topic: String,
        /// The camera: the id in the topic `/{vehicle}/camera/{id}/image`, or a foreign recording's whole topic.
        camera: Arc<str>,
        /// The picture, its sequence number cut to 32 bits as MCAP has it; or why it cannot be used.
        picture: Result<EncodedFrame, NoPicture>,
    },
    /// From here on, a camera is this one; `None` where its calibration does not say enough.
    Calibration {
        /// The camera.
        camera: Arc<str>,
        /// What it says.
        pinhole: Option<Pinhole>,
    },
    /// From here on, these landmarks are in force.
    Landmarks(LandmarkSet),
    /// Landmarks that were in force until a moment before.
    Superseded(Vec<Landmark>),
    /// What was seen in a picture when it was captured.
    Registration {
        /// The camera.
        camera: Arc<str>,
        /// What was seen.
        outcome: Outcome,
        /// Where that is, a place for each entry of the outcome.
        places: Vec<Place>,
    },
    /// What a simulator really showed in a picture.
    Truth {
        /// The camera.
        camera: Arc<str>,
        /// What it showed.
        truth: v1::Truth,
    },
    /// Where a camera stood behind the last picture of it that was registered.
    State(FollowSnapshot),
    /// A part of the file that cannot be used.
    Damage(Damage),
}

/// A part of a recording that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum Damage {
    /// The file itself.
    #[error("{0}")]
    File(Fault),
    /// A message that cannot be decoded.
    #[error("a message on {topic} is damaged: {source}")]
    Message {
        /// The topic.
        topic: String,
        /// What is wrong.
        source: RefusedPayload,
    },
    /// A message that says something impossible.
    #[error("a message on {topic} is not allowed: {source}")]
    Field {
        /// The topic.
        topic: String,
        /// Which field.
        source: InvalidField,
    },
}

/// Reads the items of one recording.
pub struct RecordedItems {
    walk: Walk<BufReader<File>>,
    path: PathBuf,
    known: BTreeMap<String, Landmark>,
    in_force: Option<LandmarkSet>,
    ended: bool,
}

impl RecordedItems {
    /// Opens a recording, whether finished, cut or still being written.
    ///
    /// # Errors
    /// When it cannot be read or is no MCAP file.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let walk = Walk::open(path, CutChunk::Skip)?;
        Ok(Self { walk, path: path.to_owned(), known: BTreeMap::new(), in_force: None, ended: false })
    }

    /// The recording's file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn item(&mut self, offset: u64, step: Step) -> Option<RecordedItem> {
        match step {
            Step::Message(message) => {
                self.message(&message).unwrap_or_else(|damage| Some(RecordedItem::Damage(damage)))
            }
            Step::Fault(kind) => Some(RecordedItem::Damage(Damage::File(Fault { offset, kind }))),
            Step::Record(mcap::records::Record::Attachment { header, data, .. })
                if header.name == LANDMARKS_ATTACHMENT =>
            {
                let set = json::set_from_json(&String::from_utf8_lossy(&data)).ok()?;
                self.known = set
                    .landmarks
                    .iter()
                    .map(|landmark| (landmark.id.clone(), (**landmark).clone()))
                    .collect();
                self.adopt(set)
            }
            Step::Record(mcap::records::Record::Attachment { header, data, .. })
                if header.name == SUPERSEDED_ATTACHMENT =>
            {
                let superseded = json::landmarks_from_json(&String::from_utf8_lossy(&data)).ok()?;
                Some(RecordedItem::Superseded(superseded))
            }
            Step::Record(_) | Step::Chunk(_) => None,
        }
    }
}

impl RecordedItems {
    fn message(&mut self, message: &RecordedMessage) -> Result<Option<RecordedItem>, Damage> {
        let schema = message.channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
        let topic = &message.channel.topic;
        if let Some(kind) = camera_pictures(topic, schema) {
            let picture = kind.read(message.sequence.into(), &message.data);
            return Ok(Some(RecordedItem::Picture {
                topic: topic.clone(),
                camera: camera_of(topic),
                picture,
            }));
        }
        let field = |source| Damage::Field { topic: topic.clone(), source };
        match schema {
            v1::Landmark::SCHEMA => {
                let (landmark, _epoch) =
                    landmark_from_wire(&decoded(topic, &message.data)?).map_err(field)?;
                self.known.insert(landmark.id.clone(), landmark);
                Ok(None)
            }
            v1::LandmarkManifest::SCHEMA => {
                let manifest = manifest_from_wire(&decoded(topic, &message.data)?).map_err(field)?;
                let landmarks = self.known.values().cloned().map(Arc::new).collect();
                let set = LandmarkSet { version: manifest.version, landmarks };
                // A set from which something was retired stands in the attachment that follows.
                Ok(if manifest.describes(&set) { self.adopt(set) } else { None })
            }
            foxglove::CameraCalibration::SCHEMA => {
                let pinhole = pinhole_from_calibration(&decoded(topic, &message.data)?);
                Ok(Some(RecordedItem::Calibration { camera: camera_of(topic), pinhole }))
            }
            v1::FollowState::SCHEMA => {
                let snapshot = follow_state_from_wire(&decoded(topic, &message.data)?).map_err(field)?;
                Ok(Some(RecordedItem::State(snapshot)))
            }
            v1::Registration::SCHEMA if topic.ends_with(AGAIN) => Ok(None),
            v1::Truth::SCHEMA => {
                let truth = decoded(topic, &message.data)?;
                Ok(Some(RecordedItem::Truth { camera: camera_of(topic), truth }))
            }
            v1::Registration::SCHEMA => {
                let wire: v1::Registration = decoded(topic, &message.data)?;
                let (_, outcome) = registration_from_wire(&wire).map_err(field)?;
                let places = places_in(&wire);
                Ok(Some(RecordedItem::Registration { camera: camera_of(topic), outcome, places }))
            }
            _ => Ok(None),
        }
    }

    fn adopt(&mut self, set: LandmarkSet) -> Option<RecordedItem> {
        if self.in_force.as_ref() == Some(&set) {
            return None;
        }
        self.in_force = Some(set.clone());
        Some(RecordedItem::Landmarks(set))
    }
}

impl Iterator for RecordedItems {
    type Item = Result<RecordedItem, RecordingError>;

    /// Nothing follows an error, which is one of the disk; damage within the file is an item.
    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            match self.walk.next_step() {
                Ok(Some((offset, step))) => {
                    if let Some(item) = self.item(offset, step) {
                        return Some(Ok(item));
                    }
                }
                Ok(None) => self.ended = true,
                Err(error) => {
                    self.ended = true;
                    return Some(Err(error));
                }
            }
        }
        None
    }
}

fn decoded<M: WireMessage>(topic: &str, data: &[u8]) -> Result<M, Damage> {
    M::from_payload(data).map_err(|source| Damage::Message { topic: topic.to_owned(), source })
}

/// Where the landmarks of a registration were said to be, in its order.
#[must_use]
pub fn places_in(wire: &v1::Registration) -> Vec<Place> {
    let place = |entry: &v1::LandmarkResult| Place { bearing_rad: entry.bearing_rad, range_m: entry.range_m };
    wire.landmarks.iter().map(place).collect()
}

/// The kind of the pictures that a camera sent on `topic`; `None` where there are others, as a picture with what was seen
/// drawn into it on `/{vehicle}/camera/{id}/burned_in`, or none.
#[must_use]
pub fn camera_pictures(topic: &str, schema: &str) -> Option<PictureKind> {
    let drawn_into = matches!(topic.split('/').collect::<Vec<_>>()[..], ["", _, "camera", _, BURNED_IN]);
    PictureKind::of_schema(schema).filter(|_| !drawn_into)
}

/// The camera that a topic belongs to: the id in `/{vehicle}/camera/{id}/…`, or a foreign recording's whole topic.
#[must_use]
pub fn camera_of(topic: &str) -> Arc<str> {
    let chunks: Vec<&str> = topic.split('/').collect();
    match chunks.as_slice() {
        ["", _vehicle, "camera", camera, _stream] => Arc::from(*camera),
        _ => Arc::from(topic),
    }
}
