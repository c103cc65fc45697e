//! Films: MP4 files with H.264 video, as pictures with the times at which they are shown.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use bytes::Bytes;
use video::{FilmReader, VideoError};
use vision::Timestamp;
use vision::frame::decode::DecodeLimits;

use crate::camera_decoder::decoded_picture;
use crate::encoded::{EncodedFrame, Encoding};

/// File name extensions of films, lower case.
pub const EXTENSIONS: [&str; 3] = ["mp4", "m4v", "mov"];

/// Why a film cannot be read, or a picture of it.
#[derive(Debug, thiserror::Error)]
#[error("cannot read the film `{}`: {source}", path.display())]
pub struct FilmError {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub source: VideoError,
}

/// The pictures of a film, decoded, numbered from 1, captured when they are shown, the first at 0.
#[derive(Debug)]
pub struct Film {
    path: PathBuf,
    reader: FilmReader<BufReader<File>>,
    frame: u64,
}

impl Film {
    /// Opens a film.
    ///
    /// # Errors
    /// When it cannot be read, or is no MP4 file with H.264 video.
    pub fn open(path: &Path) -> Result<Self, FilmError> {
        let film = File::open(path)
            .map_err(VideoError::Io)
            .and_then(|file| FilmReader::open(BufReader::new(file), DecodeLimits::default()));
        match film {
            Ok(reader) => Ok(Self { path: path.to_owned(), reader, frame: 0 }),
            Err(source) => Err(FilmError { path: path.to_owned(), source }),
        }
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Iterator for Film {
    type Item = Result<EncodedFrame, FilmError>;

    fn next(&mut self) -> Option<Self::Item> {
        let read = self.reader.next()?;
        self.frame += 1;
        Some(match read {
            Ok(film) => {
                let nanos = i64::try_from(film.shown_after.as_nanos()).unwrap_or(i64::MAX);
                let stamps = EncodedFrame {
                    sequence: self.frame,
                    captured_at: Timestamp::from_nanos(nanos),
                    encoding: Encoding::H264,
                    bytes: Bytes::new(),
                };
                Ok(decoded_picture(&stamps, film.frame))
            }
            Err(source) => Err(FilmError { path: self.path.clone(), source }),
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.reader.size_hint()
    }
}

/// Whether a name is that of a film.
#[must_use]
pub fn is_film(name: &str) -> bool {
    let extension =
        Path::new(name).extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}
