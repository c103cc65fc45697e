//! Landmark files: the JSON form of `waymark.v1.Landmark`.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use vision::{Landmark, LandmarkSet, SetVersion};
use waymark_proto::json::{LandmarkFileError, landmark_from_json, landmark_to_json};

/// The largest landmark file that is read, in bytes; sixteen shades take less than 4 KiB.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// Why a landmark file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ReadLandmarkError {
    /// It cannot be read.
    #[error("cannot read the landmark file `{}`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is not a landmark.
    #[error("`{}` is not a valid landmark", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Which field, what it says, and what is allowed.
        source: LandmarkFileError,
    },
    /// Two files describe one landmark.
    #[error("landmark `{id}` is described by `{}` and by `{}`; give each id once", first.display(), second.display())]
    Twice {
        /// The id.
        id: String,
        /// The file given first.
        first: PathBuf,
        /// The file given second.
        second: PathBuf,
    },
}

/// Reads and validates one landmark.
///
/// # Errors
/// When the file cannot be read, or a field in it is missing, unknown or out of its range.
pub fn read_landmark(path: &Path) -> Result<Landmark, ReadLandmarkError> {
    let mut text = String::new();
    File::open(path)
        .and_then(|file| file.take(MAX_FILE_BYTES).read_to_string(&mut text))
        .map_err(|source| ReadLandmarkError::Read { path: path.to_owned(), source })?;
    landmark_from_json(&text).map_err(|source| ReadLandmarkError::Invalid { path: path.to_owned(), source })
}

/// Reads landmarks into one set, sorted by id as [`LandmarkSet`] asks; its version is 0, for no leader published it.
///
/// # Errors
/// The first file that cannot be used, or an id that comes twice.
pub fn read_landmark_set(paths: &[PathBuf]) -> Result<LandmarkSet, ReadLandmarkError> {
    let mut landmarks: Vec<(Landmark, &PathBuf)> =
        paths.iter().map(|path| Ok((read_landmark(path)?, path))).collect::<Result<_, _>>()?;
    landmarks.sort_by(|(a, _), (b, _)| a.id.cmp(&b.id));
    if let Some([(landmark, first), (_, second)]) = landmarks.array_windows().find(|[a, b]| a.0.id == b.0.id)
    {
        let (id, first, second) = (landmark.id.clone(), (*first).clone(), (*second).clone());
        return Err(ReadLandmarkError::Twice { id, first, second });
    }
    let landmarks = landmarks.into_iter().map(|(landmark, _)| Arc::new(landmark)).collect();
    Ok(LandmarkSet { version: SetVersion::default(), landmarks })
}

/// The file's text for a landmark.
///
/// # Errors
/// When this build cannot describe its own messages.
pub fn landmark_text(landmark: &Landmark) -> Result<String, LandmarkFileError> {
    landmark_to_json(landmark)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vision::{ColorStats, Digest, ShapeClass, WindowPx};

    fn write(directory: &Path, name: &str, id: &str) -> PathBuf {
        let landmark = Landmark {
            id: id.to_owned(),
            revision: 1,
            window_px: WindowPx::square(12),
            shades: vec![ColorStats::uniform(100.0, 50.0)],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Block,
            size_m: None,
            digest: Digest::default(),
        };
        let path = directory.join(name);
        std::fs::write(&path, landmark_text(&landmark).unwrap()).unwrap();
        path
    }

    #[test]
    fn a_set_is_sorted_by_id() {
        let directory = tempfile::tempdir().unwrap();
        let paths = [write(directory.path(), "1.json", "red"), write(directory.path(), "2.json", "blue")];
        let set = read_landmark_set(&paths).unwrap();
        assert_eq!(set.landmarks.iter().map(|l| l.id.as_str()).collect::<Vec<_>>(), ["blue", "red"]);
    }

    #[test]
    fn an_id_given_twice_names_both_files() {
        let directory = tempfile::tempdir().unwrap();
        let paths = [write(directory.path(), "1.json", "red"), write(directory.path(), "2.json", "red")];
        let error = read_landmark_set(&paths).unwrap_err().to_string();
        assert!(error.contains("1.json") && error.contains("2.json"), "{error}");
    }

    #[test]
    fn files_that_are_no_landmark_are_named() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.json");
        assert!(matches!(read_landmark(&path), Err(ReadLandmarkError::Read { .. })));
        std::fs::write(&path, "{\"id\": \"Red\"}").unwrap();
        assert!(matches!(read_landmark(&path), Err(ReadLandmarkError::Invalid { .. })));
    }
}
