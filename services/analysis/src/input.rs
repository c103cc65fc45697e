//! Where offline frames come from: picture files, each a frame, films, or the cameras of a recording.

mod films;
mod pictures;
mod replay;

use std::path::Path;
use std::sync::Arc;

use ingest::encoded::EncodedFrame;
use ingest::films::{Film, FilmError};
use ingest::picture_message::NoPicture;
use ingest::pictures::{OpenPicturesError, PictureFiles, ReadPictureError};
use ingest::recorded::Damage;
use ingest::source::{SourceUri, SourceUriError};
use recording::RecordingError;
use vision::follow::{FollowOptions, FollowState};
use vision::{LandmarkSet, Pinhole};

use films::FilmFrames;
use pictures::PictureFrames;
use replay::Replay;

pub use pictures::NOMINAL_RATE_HZ;

/// An `INPUT` of the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// As it was given; the `input` column of the result.
    pub given: String,
    source: SourceUri,
}

/// Why an input cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// The text names no source.
    #[error(transparent)]
    Uri(#[from] SourceUriError),
    /// The text names a live source.
    #[error(
        "`{given}` is a live source, which has no end; give a directory or glob of pictures, a film, or a recording"
    )]
    Live {
        /// The text as given.
        given: String,
    },
    /// The pictures cannot be listed.
    #[error(transparent)]
    Pictures(#[from] OpenPicturesError),
    /// The film cannot be read.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The recording holds no such camera.
    #[error("`{given}` holds no pictures{}; {}", on(topic), those(topics))]
    NoImages {
        /// The text as given.
        given: String,
        /// The topic asked for.
        topic: Option<String>,
        /// What is there.
        topics: Vec<String>,
    },
}

fn on(topic: &Option<String>) -> String {
    topic.as_ref().map_or_else(String::new, |topic| format!(" on {topic}"))
}

fn those(topics: &[String]) -> String {
    match topics {
        [] => "it has no topic with foxglove.CompressedImage, CompressedVideo or RawImage".to_owned(),
        topics => format!("its image topics are {}", topics.join(", ")),
    }
}

/// One frame of an input, still encoded.
#[derive(Debug)]
pub struct InputFrame {
    /// Counts from 1 within its input and camera.
    pub frame: u64,
    /// The camera's id, where the input knows it.
    pub camera: Option<Arc<str>>,
    /// Where it was read from, for messages.
    pub name: String,
    /// The picture itself, or why it could not be read.
    pub picture: Result<EncodedFrame, FrameError>,
    /// What became of it when it was captured.
    pub live: Live,
    /// The camera, where its calibration is known.
    pub pinhole: Option<Pinhole>,
}

impl InputFrame {
    /// A frame of which nothing is known but its picture.
    fn plain(frame: u64, name: String, picture: Result<EncodedFrame, FrameError>) -> Self {
        Self { frame, camera: None, name, picture, live: Live::Unknown, pinhole: None }
    }
}

/// What a recording says of a frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Live {
    /// Nothing: plain pictures, or a recording without landmarks.
    Unknown,
    /// It was looked at.
    Registered {
        /// The landmarks that were looked for.
        landmarks: Arc<LandmarkSet>,
        /// How, where the recording says it.
        options: Option<FollowOptions>,
        /// Where the camera stood before it, where the recording says it anew.
        state: Option<FollowState>,
        /// What the recording holds of its result; `None` when it holds results of no frame of this camera.
        result: Option<Past>,
    },
    /// A newer frame replaced it before anyone looked.
    Dropped,
}

/// Whether all that a recorded result rests on is in the recording too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Past {
    /// Every picture that was looked at since the last recorded state.
    Whole,
    /// One of these pictures is missing, so that the result cannot be had again exactly.
    Missing,
}

impl Past {
    /// The name used in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::Missing => "missing",
        }
    }
}

/// Why a frame of an input could not be read.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// Its file.
    #[error(transparent)]
    File(#[from] ReadPictureError),
    /// Its place in a film.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// Its message.
    #[error(transparent)]
    Message(#[from] NoPicture),
    /// A part of the recording, which may have held several.
    #[error(transparent)]
    Damage(#[from] Damage),
    /// The recording could not be read any further.
    #[error(transparent)]
    Recording(#[from] RecordingError),
}

impl Input {
    /// Reads what `given` names, without opening it.
    ///
    /// # Errors
    /// When it names no source, or one that is not a file.
    pub fn parse(given: &str) -> Result<Self, InputError> {
        match given.parse()? {
            SourceUri::Simulator(_) | SourceUri::Zenoh(_) => {
                Err(InputError::Live { given: given.to_owned() })
            }
            source @ (SourceUri::Pictures(_) | SourceUri::Film(_) | SourceUri::Recording { .. }) => {
                Ok(Self { given: given.to_owned(), source })
            }
        }
    }

    /// The recording's file and the one image topic that was asked for, where this is a recording.
    #[must_use]
    pub fn recording(&self) -> Option<(&Path, Option<&str>)> {
        match &self.source {
            SourceUri::Recording { file, topic } => Some((file, topic.as_deref())),
            _ => None,
        }
    }

    /// Opens it from its beginning. A recording is read through once, to learn what was looked for in which frame.
    ///
    /// # Errors
    /// When nothing is there, or not what it should be.
    pub fn open(&self) -> Result<Frames, InputError> {
        match &self.source {
            SourceUri::Pictures(spec) => Ok(Frames::Pictures(PictureFrames::new(PictureFiles::open(spec)?))),
            SourceUri::Film(file) => Ok(Frames::Film(Box::new(FilmFrames::new(Film::open(file)?)))),
            SourceUri::Recording { file, topic } => {
                Ok(Frames::Recording(Box::new(Replay::open(&self.given, file, topic.as_deref())?)))
            }
            SourceUri::Simulator(_) | SourceUri::Zenoh(_) => {
                Err(InputError::Live { given: self.given.clone() })
            }
        }
    }
}

/// The frames of an input in their order.
pub enum Frames {
    /// Picture files.
    Pictures(PictureFrames),
    /// A film.
    Film(Box<FilmFrames>),
    /// A recording.
    Recording(Box<Replay>),
}

impl Frames {
    /// Whether the input says what to look for.
    #[must_use]
    pub fn brings_landmarks(&self) -> bool {
        match self {
            Self::Pictures(_) | Self::Film(_) => false,
            Self::Recording(replay) => replay.brings_landmarks(),
        }
    }
}

impl Iterator for Frames {
    type Item = InputFrame;

    fn next(&mut self) -> Option<InputFrame> {
        match self {
            Self::Pictures(frames) => frames.next(),
            Self::Film(frames) => frames.next(),
            Self::Recording(replay) => replay.next(),
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        match self {
            Self::Pictures(frames) => frames.size_hint(),
            Self::Film(frames) => frames.size_hint(),
            Self::Recording(replay) => replay.size_hint(),
        }
    }
}
