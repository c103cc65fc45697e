//! Where a camera's pictures come from, one after the other.

use std::time::Duration;

use bytes::Bytes;
use ingest::encoded::Encoding;
use ingest::pictures::PictureFiles;
use ingest::recorded::{RecordedItem, RecordedItems};
use ingest::source::SourceUri;
use simulator::{Simulator, TrueObject};
use vision::Timestamp;
use vision::frame::encode::{Quality, encode_jpeg};
use waymark_proto::images::Pinhole;

use crate::config::{AtEnd, CameraConfig};
use crate::error::CameraError;

/// One picture that is to be published.
pub(crate) struct Shot {
    /// How the bytes are to be read.
    pub(crate) encoding: Encoding,
    /// The picture.
    pub(crate) bytes: Bytes,
    /// Time since the previous picture, where the source has times of its own.
    pub(crate) since_previous: Option<Duration>,
    /// What is really there, where somebody knows.
    pub(crate) truth: Option<Vec<TrueObject>>,
}

/// A source of pictures.
pub(crate) enum Shots {
    /// Rendered.
    Simulated { simulator: Box<Simulator>, next: u64, quality: Quality },
    /// Picture files.
    Files { spec: String, files: PictureFiles, at_end: AtEnd },
    /// A camera of a recording.
    Recorded { items: Box<RecordedItems>, topic: Option<String>, previous: Option<Timestamp>, at_end: AtEnd },
}

impl Shots {
    /// Opens the source of a configuration.
    pub(crate) fn open(config: &CameraConfig) -> Result<Self, CameraError> {
        let at_end = config.at_end;
        match config.source.parse()? {
            SourceUri::Simulator(uri) => Ok(Self::Simulated {
                simulator: Box::new(Simulator::new(uri.parse()?)?),
                next: 0,
                quality: Quality::new(config.jpeg_quality).map_err(|_| CameraError::OutOfRange {
                    name: "jpeg_quality",
                    value: config.jpeg_quality.to_string(),
                    allowed: "1 to 100",
                })?,
            }),
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
            Self::Files { .. } | Self::Recorded { .. } => None,
        }
    }

    /// The next picture, `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Shot>, CameraError> {
        match self {
            Self::Simulated { simulator, next, quality } => {
                let rendered = simulator.render(*next);
                *next += 1;
                let bytes = Bytes::from(encode_jpeg(&rendered.frame, *quality)?);
                let truth = Some(rendered.truth);
                Ok(Some(Shot { encoding: Encoding::File, bytes, since_previous: None, truth }))
            }
            Self::Files { spec, files, at_end } => next_file(spec, files, *at_end),
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
    let bytes = Bytes::from(picture.bytes);
    Ok(Some(Shot { encoding: Encoding::File, bytes, since_previous: None, truth: None }))
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
        let elapsed_s =
            previous.replace(picture.captured_at).map(|before| picture.captured_at.seconds_since(before));
        let since_previous = elapsed_s.and_then(|elapsed_s| Duration::try_from_secs_f64(elapsed_s).ok());
        return Ok(Some(Shot {
            encoding: picture.encoding,
            bytes: picture.bytes,
            since_previous,
            truth: None,
        }));
    }
    Ok(None)
}
