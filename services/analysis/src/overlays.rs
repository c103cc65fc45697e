//! Pictures with the result drawn in, one file for each frame.

use std::io;
use std::path::PathBuf;

use vision::frame::encode::{EncodeError, Quality, encode_jpeg};
use vision::overlay::{Layers, draw};
use vision::{Frame, Outcome};

/// A directory of overlays.
#[derive(Clone, Debug)]
pub struct Overlays {
    directory: PathBuf,
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
}

impl Overlays {
    /// Overlays into `directory`, which is made where it is missing.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn into_directory(directory: PathBuf) -> Result<Self, OverlayError> {
        match std::fs::create_dir_all(&directory) {
            Ok(()) => Ok(Self { directory }),
            Err(source) => Err(OverlayError::Directory { path: directory, source }),
        }
    }

    /// Draws `outcome` over its frame and writes `{series}-{frame:06}.jpg`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(
        &self,
        series: &str,
        number: u64,
        frame: &mut Frame,
        outcome: &Outcome,
    ) -> Result<(), OverlayError> {
        let path = self.directory.join(format!("{series}-{number:06}.jpg"));
        draw(frame, outcome, Layers::default());
        match encode_jpeg(frame, Quality::default()) {
            Ok(bytes) => std::fs::write(&path, bytes).map_err(|source| OverlayError::Write { path, source }),
            Err(source) => Err(OverlayError::Encode { path, source }),
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
        let overlays = Overlays::into_directory(directory.path().join("new/one")).unwrap();
        let mut frame = Frame::from_rgb(64, 48, vec![80; 64 * 48 * 3]).unwrap();
        overlays.write("rink", 7, &mut frame, &Outcome::default()).unwrap();
        let path = directory.path().join("new/one/rink-000007.jpg");
        assert_eq!(crate::learn::read_frame(&path).unwrap().size(), frame.size());
    }
}
