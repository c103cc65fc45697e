//! Where a camera's pictures come from, one after the other.

use std::time::Duration;

use ingest::camera_decoder::Undecoded;
use ingest::camera_thread;
use ingest::encoded::{EncodedFrame, Encoding};
use ingest::films::Film;
use ingest::pictures::PictureFiles;
use ingest::recorded::{RecordedItem, RecordedItems};
use ingest::source::SourceUri;
use simulator::{Simulator, TrueObject};
use vision::{Pinhole, Timestamp};

use crate::coder::Content;
use crate::config::{AtEnd, CameraConfig};
use crate::error::CameraError;

/// One picture that is to be published.
pub(crate) struct Shot {
    /// The picture.
    pub(crate) content: Content,
    /// Time since the previous picture, where the source has times of its own.
    pub(crate) since_previous: Option<Duration>,
    /// What is really there, where somebody knows.
    pub(crate) truth: Option<Vec<TrueObject>>,
}

/// A source of pictures.
pub(crate) enum Shots {
    /// Rendered.
    Simulated { simulator: Box<Simulator>, next: u64 },
    /// Picture files.
    Files { spec: String, files: PictureFiles, at_end: AtEnd },
    /// A film, whose frames are decoded.
    Film { film: Box<Film>, previous: Option<Timestamp>, at_end: AtEnd },
    /// A camera of a recording.
    Recorded { items: Box<RecordedItems>, topic: Option<String>, previous: Option<Timestamp>, at_end: AtEnd },
}

impl Shots {
    /// Opens the source of a configuration.
    pub(crate) fn open(config: &CameraConfig) -> Result<Self, CameraError> {
        let at_end = config.at_end;
        match config.source.parse()? {
            SourceUri::Simulator(uri) => {
                Ok(Self::Simulated { simulator: Box::new(Simulator::new(uri.parse()?)?), next: 0 })
            }
            SourceUri::Film(file) => {
                Ok(Self::Film { film: Box::new(Film::open(&file)?), previous: None, at_end })
            }
            SourceUri::Pictures(spec) => {
                let files = PictureFiles::open(&spec)?;
                Ok(Self::Files { spec, files, at_end })
            }
            SourceUri::Recording { file, topic } => {
                let items = Box::new(RecordedItems::open(&file)?);
                Ok(Self::Recorded { items, topic, previous: None, at_end })
            }
            SourceUri::Zenoh(key) => Err(CameraError::AlreadyPublished(key)),
        }
    }

    /// The camera's calibration, where it is known.
    pub(crate) fn pinhole(&self) -> Option<Pinhole> {
        let Self::Simulated { simulator, .. } = self else { return None };
        let intrinsics = simulator.calibration();
        let [centre_x_px, centre_y_px] = intrinsics.principal_px;
        Some(Pinhole { size: intrinsics.size, focal_px: intrinsics.focal_px, centre_x_px, centre_y_px })
    }

    /// Pictures per second that the source asks for.
    pub(crate) fn frame_rate_hz(&self) -> Option<f64> {
        match self {
            Self::Simulated { simulator, .. } => Some(simulator.options().frame_rate_hz),
            Self::Files { .. } | Self::Film { .. } | Self::Recorded { .. } => None,
        }
    }

    /// The next picture, `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Shot>, CameraError> {
        match self {
            Self::Simulated { simulator, next } => {
                let rendered = simulator.render(*next);
                *next += 1;
                let content = Content::Frame(rendered.frame);
                Ok(Some(Shot { content, since_previous: None, truth: Some(rendered.truth) }))
            }
            Self::Files { spec, files, at_end } => next_file(spec, files, *at_end),
            Self::Film { film, previous, at_end } => {
                let mut next = film.next();
                if next.is_none() && *at_end == AtEnd::Repeat && previous.take().is_some() {
                    **film = Film::open(film.path())?;
                    next = film.next();
                }
                while let Some(Err(error)) = &next {
                    tracing::warn!(%error, "a picture is left out");
                    next = film.next();
                }
                let Some(picture) = next.transpose()? else { return Ok(None) };
                let since_previous = since(previous, picture.captured_at);
                let frame = camera_thread::decode(&picture).map_err(Undecoded::from)?;
                Ok(Some(Shot { content: Content::Frame(frame), since_previous, truth: None }))
            }
            Self::Recorded { items, topic, previous, at_end } => {
                match next_recorded(items, topic, previous)? {
                    None if *at_end == AtEnd::Repeat && previous.take().is_some() => {
                        **items = RecordedItems::open(items.path())?;
                        next_recorded(items, topic, previous)
                    }
                    shot => Ok(shot),
                }
            }
        }
    }
}

fn next_file(spec: &str, files: &mut PictureFiles, at_end: AtEnd) -> Result<Option<Shot>, CameraError> {
    let mut next = files.next();
    if next.is_none() && at_end == AtEnd::Repeat {
        *files = PictureFiles::open(spec)?;
        next = files.next();
    }
    let Some(picture) = next.transpose()? else { return Ok(None) };
    let content = Content::Encoded(EncodedFrame {
        sequence: 0,
        captured_at: Timestamp::default(),
        encoding: Encoding::File,
        bytes: picture.bytes.into(),
    });
    Ok(Some(Shot { content, since_previous: None, truth: None }))
}

/// Time since the picture before, which this one replaces.
fn since(previous: &mut Option<Timestamp>, captured_at: Timestamp) -> Option<Duration> {
    let elapsed_s = previous.replace(captured_at).map(|before| captured_at.seconds_since(before));
    elapsed_s.and_then(|elapsed_s| Duration::try_from_secs_f64(elapsed_s).ok())
}

/// The next picture of the topic that is meant: the first one met, where none is named.
fn next_recorded(
    items: &mut RecordedItems,
    meant: &mut Option<String>,
    previous: &mut Option<Timestamp>,
) -> Result<Option<Shot>, CameraError> {
    while let Some(item) = items.next().transpose()? {
        let RecordedItem::Picture { topic, picture: Ok(picture), .. } = item else { continue };
        if *meant.get_or_insert_with(|| topic.clone()) != topic {
            continue;
        }
        let since_previous = since(previous, picture.captured_at);
        return Ok(Some(Shot { content: Content::Encoded(picture), since_previous, truth: None }));
    }
    Ok(None)
}
