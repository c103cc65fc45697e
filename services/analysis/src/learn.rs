//! A landmark learned from regions of picture files and of films.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};
use std::time::Duration;

use ingest::camera_thread;
use ingest::films::{Film, FilmError, is_film};
use ingest::pictures::{ReadPictureError, read_picture};
use vision::frame::decode::{DecodeError, DecodeLimits, decode};
use vision::learn::{LearnError, LearnOptions, learn};
use vision::{Frame, Landmark, RectPx, Timestamp};
use waymark_proto::digest::landmark_digest;
use waymark_proto::keys::{Id, InvalidId};

use crate::region::{PictureRegion, RegionError};

/// Why pictures do not make a landmark.
#[derive(Debug, thiserror::Error)]
pub enum LearnFromFilesError {
    /// The id.
    #[error(transparent)]
    Id(#[from] InvalidId),
    /// A picture's file.
    #[error(transparent)]
    File(#[from] ReadPictureError),
    /// A picture's content.
    #[error("cannot decode `{}`", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: DecodeError,
    },
    /// A film.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A film without a picture.
    #[error("`{}` shows no picture", path.display())]
    NoFrame {
        /// The film.
        path: PathBuf,
    },
    /// A region does not lie in its picture.
    #[error("cannot learn from `{}`", path.display())]
    Region {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: RegionError,
    },
    /// The regions do not make a landmark.
    #[error(transparent)]
    Learn(#[from] LearnError),
}

/// Learns a landmark; a picture without a region is the object from edge to edge. The digest is filled in.
///
/// # Errors
/// The first picture, region or option that does not work.
pub fn learn_from_files(
    regions: &[PictureRegion],
    options: &LearnOptions,
) -> Result<Landmark, LearnFromFilesError> {
    Id::new("id", &options.id)?;
    let mut frames = Frames::new();
    for PictureRegion { file, shown_at, .. } in regions {
        if let Entry::Vacant(place) = frames.entry((file.as_path(), *shown_at)) {
            place.insert(match shown_at {
                None if !is_film(&file.to_string_lossy()) => read_frame(file)?,
                shown_at => film_frame(file, shown_at.unwrap_or_default())?,
            });
        }
    }
    let boxes = regions.iter().map(|region| region_of(region, &frames));
    let mut landmark = learn(&boxes.collect::<Result<Vec<_>, _>>()?, options)?;
    landmark.digest = landmark_digest(&landmark);
    Ok(landmark)
}

/// Frames by their file and the time at which they are shown in it.
type Frames<'a> = BTreeMap<(&'a Path, Option<Duration>), Frame>;

/// The frame of a film that is shown at a time.
fn film_frame(path: &Path, shown_at: Duration) -> Result<Frame, LearnFromFilesError> {
    let mut shown = None;
    for picture in Film::open(path)? {
        let picture = picture?;
        if picture.captured_at.seconds_since(Timestamp::default()) > shown_at.as_secs_f64() {
            break;
        }
        shown = Some(picture);
    }
    let none = || LearnFromFilesError::NoFrame { path: path.to_owned() };
    camera_thread::decode(&shown.ok_or_else(none)?)
        .map_err(|source| LearnFromFilesError::Decode { path: path.to_owned(), source })
}

fn region_of<'a>(
    wanted: &'a PictureRegion,
    frames: &'a Frames<'a>,
) -> Result<(&'a Frame, RectPx), LearnFromFilesError> {
    let frame = &frames[&(wanted.file.as_path(), wanted.shown_at)];
    let whole = RectPx::whole(frame.size());
    let rect = wanted.region.map_or(Ok(whole), |region| region.in_picture(frame.size()));
    rect.map(|rect| (frame, rect))
        .map_err(|source| LearnFromFilesError::Region { path: wanted.file.clone(), source })
}

/// Reads and decodes one picture.
///
/// # Errors
/// When it cannot be read, is damaged, or is too large.
pub fn read_frame(path: &Path) -> Result<Frame, LearnFromFilesError> {
    let picture = read_picture(path.to_owned())?;
    decode(&picture.bytes, &DecodeLimits::default())
        .map_err(|source| LearnFromFilesError::Decode { path: path.to_owned(), source })
}
