//! The pictures of a recording as files: as they were recorded, or with the recorded result drawn in.
//!
//! Pictures of a stream (H.264) and bare pixels are no files by themselves; they are written as PNG.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ingest::encoded::{EncodedFrame, Encoding};
use ingest::recorded::{RecordedItem, RecordedItems};
use recording::RecordingError;
use vision::frame::decode::{PictureFormat, sniff};
use vision::frame::encode::encode_png;
use vision::{Frame, Outcome};

use super::Exported;
use crate::chosen_pictures::ChosenPictures;
use crate::overlays::{OverlayError, OverlaySeries, Overlays, SeriesOrder, series_name};
use crate::recorded::RecordedOutcomes;

/// Where pictures go.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The directory of pictures as they were recorded.
    pub frames: Option<PathBuf>,
    /// Pictures, or a film, with the recorded result drawn in; frames without one are left out.
    pub overlays: Option<Overlays>,
}

/// Why pictures could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportPictureError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// An overlay cannot be written.
    #[error(transparent)]
    Overlay(#[from] OverlayError),
    /// A picture cannot be written.
    #[error("cannot write the picture `{}`", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

/// Writes the pictures of one recording as `{series}-{frame:06}.jpg` (or `.png`), the series being named as those of
/// `register --overlays`: after the recording, its number among several, and the camera.
///
/// # Errors
/// When the recording cannot be read or a file not be written; pictures that cannot be decoded are counted.
pub fn export_pictures(
    file: &Path,
    number: Option<usize>,
    pictures: &Pictures,
) -> Result<Exported, ExportPictureError> {
    let mut export = Export {
        file,
        number,
        pictures,
        outcomes: RecordedOutcomes::open(file, None)?,
        decoders: ChosenPictures::default(),
        drawn: BTreeMap::new(),
        done: Exported::default(),
        pixels: Vec::new(),
    };
    let mut counts: BTreeMap<Arc<str>, u64> = BTreeMap::new();
    for item in RecordedItems::open(file)? {
        let RecordedItem::Picture { camera, picture, .. } = item? else { continue };
        let count = counts.entry(Arc::clone(&camera)).or_default();
        *count += 1;
        match picture {
            Ok(picture) => export.picture(*count, &camera, &picture)?,
            Err(_) => export.done.damaged += 1,
        }
    }
    export.drawn.into_values().try_for_each(OverlaySeries::finish)?;
    Ok(export.done)
}

struct Export<'a> {
    file: &'a Path,
    /// The recording's number among several.
    number: Option<usize>,
    pictures: &'a Pictures,
    outcomes: RecordedOutcomes,
    decoders: ChosenPictures,
    drawn: BTreeMap<Arc<str>, OverlaySeries>,
    done: Exported,
    /// Storage of the last frame, used again for the next.
    pixels: Vec<u8>,
}

impl Export<'_> {
    fn picture(
        &mut self,
        number: u64,
        camera: &Arc<str>,
        picture: &EncodedFrame,
    ) -> Result<(), ExportPictureError> {
        let as_recorded = file_extension(picture).filter(|_| self.pictures.frames.is_some());
        if let Some(extension) = as_recorded {
            self.write(number, camera, extension, &picture.bytes)?;
        }
        let outcome = match &self.pictures.overlays {
            Some(_) => self.outcomes.take(camera, picture.captured_at, picture.sequence)?,
            None => None,
        };
        let as_png = self.pictures.frames.is_some() && as_recorded.is_none();
        if outcome.is_none() && !as_png {
            self.decoders.pass_over(camera, picture);
            return Ok(());
        }
        let Ok(mut frame) = self.decoders.decode(camera, picture, std::mem::take(&mut self.pixels)) else {
            self.done.damaged += 1;
            return Ok(());
        };
        if as_png && let Ok(png) = encode_png(&frame) {
            self.write(number, camera, "png", &png)?;
        }
        if let Some(outcome) = outcome {
            self.draw(number, camera, &mut frame, &outcome)?;
        }
        self.pixels = frame.into_rgb();
        Ok(())
    }

    fn write(
        &mut self,
        number: u64,
        camera: &str,
        extension: &str,
        bytes: &[u8],
    ) -> Result<(), ExportPictureError> {
        let Some(directory) = &self.pictures.frames else { return Ok(()) };
        let path = directory.join(format!("{}-{number:06}.{extension}", self.series(camera)));
        self.done.written += 1;
        std::fs::write(&path, bytes).map_err(|source| ExportPictureError::Write { path, source })
    }

    fn draw(
        &mut self,
        number: u64,
        camera: &Arc<str>,
        frame: &mut Frame,
        outcome: &Outcome,
    ) -> Result<(), ExportPictureError> {
        let Some(overlays) = &self.pictures.overlays else { return Ok(()) };
        let alone = self.number.is_none() && self.drawn.is_empty();
        let order = if alone { SeriesOrder::First } else { SeriesOrder::Later };
        let name = self.series(camera);
        let series = self.drawn.entry(Arc::clone(camera)).or_insert_with(|| overlays.series(&name, order));
        self.done.written += 1;
        Ok(series.write(number, frame, outcome)?)
    }

    fn series(&self, camera: &str) -> String {
        series_name(&self.file.to_string_lossy(), self.number, Some(camera))
    }
}

/// What a picture's file is called if it is one as it is.
fn file_extension(picture: &EncodedFrame) -> Option<&'static str> {
    match (&picture.encoding, sniff(&picture.bytes)) {
        (Encoding::File, Some(PictureFormat::Jpeg)) => Some("jpg"),
        (Encoding::File, Some(PictureFormat::Png)) => Some("png"),
        _ => None,
    }
}
