//! A recording written again with what was registered in it now, beside what was registered live.
//!
//! The new results of `/{vehicle}/camera/{c}/image` stand on `/{vehicle}/camera/{c}/registration/again`, their drawings
//! on `/{vehicle}/camera/{c}/annotations/again`, right behind their pictures and with these' log time. Every message,
//! record and attachment of the original stays as it is.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ingest::recorded::{AGAIN, camera_of, camera_pictures};
use recording::recover::RecoverReport;
use recording::rewrite::Rewrite;
use recording::walk::RecordedMessage;
use recording::{Attachment, ChannelSpec, Latch, Message, RecordingError, Schema, WriterOptions};
use vision::{LandmarkSet, Outcome, Place};
use waymark_proto::annotations::annotations;
use waymark_proto::convert::registration_to_wire;
use waymark_proto::json::{LandmarkFileError, set_to_json};
use waymark_proto::payload::WireMessage;
use waymark_proto::{foxglove, v1};

/// Name of the metadata record that says how the new results were made.
const AGAIN_RECORD: &str = "waymark.again";
/// Name of the attachment with the landmarks that were looked for, where they are not the recording's own.
const LANDMARKS_AGAIN: &str = "landmarks.again.json";

/// A recording being written again.
pub struct AgainWriter {
    rewrite: Rewrite,
    input: PathBuf,
    topic: Option<String>,
    /// Pictures copied so far, by camera.
    copied: BTreeMap<Arc<str>, u64>,
    channels: BTreeMap<Arc<str>, Channels>,
    first_log_time_ns: Option<u64>,
}

/// The new channels of one camera.
struct Channels {
    registration: Arc<ChannelSpec>,
    annotations: Arc<ChannelSpec>,
}

/// A message that was copied, and the camera that it is a picture of, if it is one that results are given for.
struct Copied {
    message: RecordedMessage,
    camera: Option<Arc<str>>,
}

/// Why a recording could not be written again.
#[derive(Debug, thiserror::Error)]
pub enum AgainError {
    /// It cannot be read, or the new one not written.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// It was written by this before.
    #[error("`{}` holds results of another run already, on {topic}; give the recording it was made from", path.display())]
    Twice {
        /// The recording.
        path: PathBuf,
        /// Where they are.
        topic: String,
    },
    /// It changed while it was read.
    #[error("`{}` has no picture {frame} of camera {camera} any more; was it changed meanwhile?", path.display())]
    Gone {
        /// The recording.
        path: PathBuf,
        /// Counts from 1 within its camera.
        frame: u64,
        /// The camera.
        camera: Arc<str>,
    },
    /// The landmarks cannot be written down.
    #[error("the landmarks cannot be attached")]
    Landmarks(#[from] LandmarkFileError),
}

impl AgainWriter {
    /// Begins to write `input` again as `output`; `topic` is the one image topic that results are given for, if only one.
    ///
    /// # Errors
    /// When `input` is no recording, or `output` exists or cannot be made.
    pub fn begin(input: &Path, output: &Path, topic: Option<&str>) -> Result<Self, AgainError> {
        Ok(Self {
            rewrite: Rewrite::begin(input, output, &WriterOptions::default())?,
            input: input.to_owned(),
            topic: topic.map(str::to_owned),
            copied: BTreeMap::new(),
            channels: BTreeMap::new(),
            first_log_time_ns: None,
        })
    }

    /// Adds the result, with its places, of picture number `frame` of `camera`; results must come in the order of the pictures.
    ///
    /// # Errors
    /// When that picture is not there, or the disk fails.
    pub fn add(
        &mut self,
        frame: u64,
        camera: &Arc<str>,
        outcome: &Outcome,
        places: &[Place],
    ) -> Result<(), AgainError> {
        let picture = self.copy_to(frame, camera)?;
        let registration = encoded(&registration_to_wire(camera, outcome, places));
        let drawing = encoded(&annotations(outcome));
        let channels = self
            .channels
            .entry(Arc::clone(camera))
            .or_insert_with(|| Channels::of_image(&picture.channel.topic));
        let message = |channel: &Arc<ChannelSpec>, data: Vec<u8>| Message {
            channel: Arc::clone(channel),
            log_time_ns: picture.log_time_ns,
            publish_time_ns: picture.publish_time_ns,
            sequence: picture.sequence,
            data: data.into(),
            latch: Latch::None,
        };
        self.rewrite.add(&message(&channels.registration, registration))?;
        Ok(self.rewrite.add(&message(&channels.annotations, drawing))?)
    }

    /// Copies the rest and finishes the file, saying in it how the results were made.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn finish(
        mut self,
        made: BTreeMap<String, String>,
        landmarks: Option<&LandmarkSet>,
    ) -> Result<RecoverReport, AgainError> {
        while self.copy_message()?.is_some() {}
        self.rewrite.add_metadata(AGAIN_RECORD, made)?;
        if let Some(set) = landmarks {
            self.rewrite.attach(&Attachment {
                name: LANDMARKS_AGAIN.to_owned(),
                media_type: "application/json".to_owned(),
                log_time_ns: self.first_log_time_ns.unwrap_or_default(),
                data: set_to_json(set)?.into(),
            })?;
        }
        Ok(self.rewrite.finish()?)
    }

    fn copy_to(&mut self, frame: u64, camera: &Arc<str>) -> Result<RecordedMessage, AgainError> {
        while let Some(Copied { message, camera: copied_camera }) = self.copy_message()? {
            let Some(copied_camera) = copied_camera else { continue };
            let count = self.copied.entry(Arc::clone(&copied_camera)).or_default();
            *count += 1;
            if *count == frame && copied_camera == *camera {
                return Ok(message);
            }
        }
        Err(AgainError::Gone { path: self.input.clone(), frame, camera: Arc::clone(camera) })
    }

    fn copy_message(&mut self) -> Result<Option<Copied>, AgainError> {
        let Some(message) = self.rewrite.copy_message()? else { return Ok(None) };
        self.first_log_time_ns.get_or_insert(message.log_time_ns);
        let topic = &message.channel.topic;
        if topic.ends_with(AGAIN) {
            return Err(AgainError::Twice { path: self.input.clone(), topic: topic.clone() });
        }
        let schema = message.channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
        let wanted = self.topic.as_ref().is_none_or(|wanted| wanted == topic);
        let camera = (wanted && camera_pictures(topic, schema).is_some()).then(|| camera_of(topic));
        Ok(Some(Copied { message, camera }))
    }
}

impl Channels {
    fn of_image(topic: &str) -> Self {
        let base = topic.strip_suffix("/image").unwrap_or(topic);
        Self {
            registration: channel::<v1::Registration>(format!("{base}/registration{AGAIN}")),
            annotations: channel::<foxglove::ImageAnnotations>(format!("{base}/annotations{AGAIN}")),
        }
    }
}

fn encoded<M: WireMessage>(message: &M) -> Vec<u8> {
    message.encode_to_vec()
}

/// A channel that nothing was ever sent on.
fn channel<M: WireMessage>(topic: String) -> Arc<ChannelSpec> {
    let schema =
        Schema { name: M::SCHEMA.to_owned(), file_descriptor_set: M::descriptors().into_owned().into() };
    Arc::new(ChannelSpec { topic, key_expression: String::new(), schema })
}
