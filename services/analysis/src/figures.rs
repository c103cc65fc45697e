//! The figures of a recorded drive: how often each landmark was seen, how well it was predicted and, where a simulator
//! says what was true, how well it was measured.

mod landmark;
mod spread;

use std::collections::BTreeSet;
use std::path::Path;

use recording::RecordingError;
use recording::info::Info;
use serde::{Deserialize, Serialize};

use crate::drive::{CameraDrive, Drive};

pub use landmark::{LandmarkFigures, Observation, observations};
pub use spread::Spread;

/// The figures of one recording. What is unknown is null.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Figures {
    /// The file as it was given.
    pub recording: String,
    /// Its size.
    pub bytes: u64,
    /// From the first message to the last.
    pub span_s: Option<f64>,
    /// Each camera.
    pub cameras: Vec<CameraFigures>,
    /// Topics with gaps or losses worth a look.
    pub topics: Vec<TopicFigures>,
    /// Damaged parts of the file, in words.
    pub damage: Vec<String>,
}

/// One camera.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CameraFigures {
    /// Its id.
    pub camera: String,
    /// Pictures in the recording.
    pub pictures: u64,
    /// Frames with a result in the recording.
    pub registered: u64,
    /// Pictures without one: a newer one replaced them, or their result is in another file.
    pub not_registered: u64,
    /// Longest time between two results.
    pub longest_gap_s: Option<f64>,
    /// Each landmark that was looked for.
    pub landmarks: Vec<LandmarkFigures>,
}

/// What one topic says of losses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TopicFigures {
    /// Its name.
    pub topic: String,
    /// Messages.
    pub messages: u64,
    /// Messages a second.
    pub rate_hz: Option<f64>,
    /// Longest time between two messages.
    pub longest_gap_s: Option<f64>,
    /// Numbers that never arrived at the recorder.
    pub skipped: u64,
    /// Messages that the recorder could not keep; unknown in a file that it did not finish.
    pub lost: Option<u64>,
}

impl Figures {
    /// The figures of the recording `path`, whose drive was read already.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn of(path: &Path, drive: &Drive) -> Result<Self, RecordingError> {
        let info = Info::read(path)?;
        let span_s = info.log_span_ns().map(|(first, last)| seconds(last - first));
        Ok(Self {
            recording: path.display().to_string(),
            bytes: info.bytes,
            span_s,
            cameras: drive.cameras.iter().map(|(camera, drive)| CameraFigures::of(camera, drive)).collect(),
            topics: topics(&info),
            damage: drive.damage.clone(),
        })
    }
}

impl CameraFigures {
    fn of(camera: &str, drive: &CameraDrive) -> Self {
        let times: Vec<u64> =
            drive.registered().map(|(_, outcome)| outcome.captured_at.nanos.max(0) as u64).collect();
        let gap = times.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).max();
        let ids: BTreeSet<&str> = drive
            .registered()
            .flat_map(|(_, outcome)| outcome.landmarks.iter().map(|landmark| landmark.landmark.as_str()))
            .collect();
        let without = drive.frames.values().filter(|frame| frame.number.is_some() && frame.outcome.is_none());
        Self {
            camera: camera.to_owned(),
            pictures: drive.pictures,
            registered: times.len() as u64,
            not_registered: without.count() as u64,
            longest_gap_s: gap.map(seconds),
            landmarks: ids.into_iter().map(|id| LandmarkFigures::of(id, drive)).collect(),
        }
    }
}

fn topics(info: &Info) -> Vec<TopicFigures> {
    let figures = info.topics.iter().map(|(name, topic)| TopicFigures {
        topic: name.clone(),
        messages: topic.messages,
        rate_hz: topic.rate_hz(),
        longest_gap_s: topic.longest_gap.map(|gap| seconds(gap.length_ns)),
        skipped: topic.sequences_skipped,
        lost: info.accounts.as_ref().map(|accounts| accounts.get(name).map_or(0, |account| account.lost())),
    });
    figures.collect()
}

fn seconds(ns: u64) -> f64 {
    ns as f64 * 1e-9
}
