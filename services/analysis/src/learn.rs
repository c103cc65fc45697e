//! A landmark learned from regions of picture files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ingest::pictures::{ReadPictureError, read_picture};
use vision::frame::decode::{DecodeError, DecodeLimits, decode};
use vision::learn::{LearnError, LearnOptions, learn};
use vision::{Frame, Landmark, RectPx};
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
    let mut frames: BTreeMap<&Path, Frame> = BTreeMap::new();
    for PictureRegion { file, .. } in regions {
        if !frames.contains_key(file.as_path()) {
            frames.insert(file, read_frame(file)?);
        }
    }
    let boxes = regions.iter().map(|region| region_of(region, &frames));
    let mut landmark = learn(&boxes.collect::<Result<Vec<_>, _>>()?, options)?;
    landmark.digest = landmark_digest(&landmark);
    Ok(landmark)
}

fn region_of<'a>(
    wanted: &PictureRegion,
    frames: &'a BTreeMap<&Path, Frame>,
) -> Result<(&'a Frame, RectPx), LearnFromFilesError> {
    let frame = &frames[wanted.file.as_path()];
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
