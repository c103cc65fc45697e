//! Pictures with the result drawn in: a file for each frame, or a film.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::PathBuf;
use std::time::Duration;

use video::{FilmWriter, VideoError};
use vision::frame::encode::{EncodeError, Quality, encode_jpeg};
use vision::overlay::{Layers, draw};
use vision::{Frame, Outcome, Timestamp};

/// Where overlays go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Overlays {
    /// A JPEG for each frame, in this directory.
    Pictures(PathBuf),
    /// A film of each camera: the first camera's in this file, those of others in files named after it.
    Film(PathBuf),
}

/// Why an overlay is not there.
#[derive(Debug, thiserror::Error)]
pub enum OverlayError {
    /// The directory cannot be made.
    #[error("cannot make the directory `{}` for overlays", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file cannot be written.
    #[error("cannot write the overlay `{}`", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The picture cannot be encoded.
    #[error("cannot encode the overlay `{}`", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// Why.
        source: EncodeError,
    },
    /// The film cannot be written.
    #[error("cannot write the film `{}`: {source}", path.display())]
    Film {
        /// The file.
        path: PathBuf,
        /// Why.
        source: VideoError,
    },
}

impl Overlays {
    /// Overlays to `path`: a film where it ends in `.mp4`, else pictures in this directory, which is made where it is
    /// missing.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn to(path: PathBuf) -> Result<Self, OverlayError> {
        if path.extension().is_some_and(|extension| extension == "mp4") {
            return Ok(Self::Film(path));
        }
        match std::fs::create_dir_all(&path) {
            Ok(()) => Ok(Self::Pictures(path)),
            Err(source) => Err(OverlayError::Directory { path, source }),
        }
    }

    /// The overlays of one camera of one input, called `name`.
    #[must_use]
    pub fn series(&self, name: &str, place: SeriesOrder) -> OverlaySeries {
        match self {
            Self::Pictures(directory) => {
                OverlaySeries::Pictures { directory: directory.clone(), name: name.to_owned() }
            }
            Self::Film(file) => {
                let stem = file.file_stem().unwrap_or_default().to_string_lossy();
                let path = match place {
                    SeriesOrder::First => file.clone(),
                    SeriesOrder::Later => file.with_file_name(format!("{stem}-{name}.mp4")),
                };
                OverlaySeries::Film(Box::new(FilmSeries { path, film: None }))
            }
        }
    }
}

/// Whether a series has the name that was given to itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeriesOrder {
    /// The first camera of the only input.
    First,
    /// Any other.
    Later,
}

/// The overlays of one camera.
#[derive(Debug)]
pub enum OverlaySeries {
    /// `{directory}/{name}-{frame:06}.jpg`.
    Pictures {
        /// Where.
        directory: PathBuf,
        /// What they are called.
        name: String,
    },
    /// A film.
    Film(Box<FilmSeries>),
}

/// A film that is being written.
#[derive(Debug)]
pub struct FilmSeries {
    path: PathBuf,
    /// The film and when its first frame was captured.
    film: Option<(FilmWriter<BufWriter<File>>, Timestamp)>,
}

impl OverlaySeries {
    /// Draws `outcome` over its frame and writes it.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&mut self, number: u64, frame: &mut Frame, outcome: &Outcome) -> Result<(), OverlayError> {
        draw(frame, outcome, Layers::default());
        match self {
            Self::Pictures { directory, name } => {
                let path = directory.join(format!("{name}-{number:06}.jpg"));
                match encode_jpeg(frame, Quality::default()) {
                    Ok(bytes) => {
                        std::fs::write(&path, bytes).map_err(|source| OverlayError::Write { path, source })
                    }
                    Err(source) => Err(OverlayError::Encode { path, source }),
                }
            }
            Self::Film(series) => series.push(frame, outcome.captured_at),
        }
    }

    /// Completes the film; pictures are complete already.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(self) -> Result<(), OverlayError> {
        match self {
            Self::Film(series) => series.finish(),
            Self::Pictures { .. } => Ok(()),
        }
    }
}

impl FilmSeries {
    fn push(&mut self, frame: &Frame, captured_at: Timestamp) -> Result<(), OverlayError> {
        let (film, begun) = match &mut self.film {
            Some(film) => film,
            none => {
                let film = File::create(&self.path)
                    .map_err(VideoError::Io)
                    .and_then(|file| FilmWriter::new(BufWriter::new(file)));
                let path = || self.path.clone();
                none.insert((
                    film.map_err(|source| OverlayError::Film { path: path(), source })?,
                    captured_at,
                ))
            }
        };
        let elapsed_s = captured_at.seconds_since(*begun);
        let at = Duration::try_from_secs_f64(elapsed_s).unwrap_or_default();
        film.push(frame, at).map_err(|source| OverlayError::Film { path: self.path.clone(), source })
    }

    fn finish(self) -> Result<(), OverlayError> {
        let Self { path, film } = self;
        match film.map(|(film, _)| film.finish()) {
            Some(Err(source)) => Err(OverlayError::Film { path, source }),
            Some(Ok(_)) | None => Ok(()),
        }
    }
}

/// The name of an input's (and camera's) overlays: its last path component, with its number where there are several
/// inputs, as these may share one.
#[must_use]
pub fn series_name(given: &str, number: Option<usize>, camera: Option<&str>) -> String {
    let last = given.trim_end_matches('/').rsplit('/').find(|part| !part.is_empty()).unwrap_or("input");
    let parts = [number.map(|number| number.to_string()), Some(last.to_owned()), camera.map(str::to_owned)];
    let name = parts.into_iter().flatten().collect::<Vec<_>>().join("-");
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    name.chars().map(|c| if is_plain(c) { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_are_told_apart_and_stay_in_their_directory() {
        assert_eq!(series_name("drives/rink/", None, None), "rink");
        assert_eq!(series_name("left/*.jpg", Some(2), None), "2-_.jpg");
        assert_eq!(series_name("a/b.mcap", Some(1), Some("/v2/../front")), "1-b.mcap-_v2_.._front");
        assert_eq!(series_name("/", None, None), "input");
    }

    #[test]
    fn an_overlay_is_a_picture_of_the_same_size() {
        let directory = tempfile::tempdir().unwrap();
        let overlays = Overlays::to(directory.path().join("new/one")).unwrap();
        let mut frame = Frame::from_rgb(64, 48, vec![80; 64 * 48 * 3]).unwrap();
        overlays.series("rink", SeriesOrder::Later).write(7, &mut frame, &Outcome::default()).unwrap();
        let path = directory.path().join("new/one/rink-000007.jpg");
        assert_eq!(crate::learn::read_frame(&path).unwrap().size(), frame.size());
    }

    #[test]
    fn a_film_shows_each_frame_when_it_was_captured() {
        let directory = tempfile::tempdir().unwrap();
        let overlays = Overlays::to(directory.path().join("drive.mp4")).unwrap();
        let mut series = overlays.series("left", SeriesOrder::Later);
        let mut frame = Frame::from_rgb(64, 48, vec![80; 64 * 48 * 3]).unwrap();
        for (number, captured_ms) in [(1, 500), (2, 540), (3, 620)] {
            let captured_at = Timestamp::from_nanos(captured_ms * 1_000_000);
            series.write(number, &mut frame, &Outcome { captured_at, ..Outcome::default() }).unwrap();
        }
        series.finish().unwrap();
        let film = ingest::films::Film::open(&directory.path().join("drive-left.mp4")).unwrap();
        let times: Vec<i64> = film.map(|frame| frame.unwrap().captured_at.nanos / 1_000_000).collect();
        assert_eq!(times, [0, 40, 120]);
    }
}
