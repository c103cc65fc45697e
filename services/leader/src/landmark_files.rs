//! Landmarks as files: one JSON file each, named after the id.

use std::fs;
use std::path::{Path, PathBuf};

use vision::{Landmark, LandmarkSet};
use waymark_proto::json::{landmark_from_json, landmark_to_json};

use crate::error::LandmarkFilesError;

const EXTENSION: &str = "json";

/// Reads landmark files; a directory stands for every `*.json` in it, in the order of their names.
///
/// # Errors
/// When one cannot be read or holds no landmark, or a directory holds no such file.
pub fn read_landmarks(paths: &[PathBuf]) -> Result<Vec<Landmark>, LandmarkFilesError> {
    let mut landmarks = Vec::new();
    for path in paths {
        if path.is_dir() {
            for file in files_in(path)? {
                landmarks.push(read_landmark(&file)?);
            }
        } else {
            landmarks.push(read_landmark(path)?);
        }
    }
    Ok(landmarks)
}

/// Reads one landmark file.
///
/// # Errors
/// When it cannot be read or holds no landmark.
pub fn read_landmark(path: &Path) -> Result<Landmark, LandmarkFilesError> {
    let text = fs::read_to_string(path).map_err(|source| io(path, source))?;
    landmark_from_json(&text)
        .map_err(|source| LandmarkFilesError::Content { path: path.to_owned(), source: Box::new(source) })
}

/// Writes every landmark of `set` to `directory`, which is made when it does not exist. Files of landmarks that the
/// set does not have are left alone. Returns the files written.
///
/// # Errors
/// When a file cannot be written.
pub fn write_landmarks(directory: &Path, set: &LandmarkSet) -> Result<Vec<PathBuf>, LandmarkFilesError> {
    fs::create_dir_all(directory).map_err(|source| io(directory, source))?;
    let mut written = Vec::new();
    for landmark in &set.landmarks {
        // An id is safe as a file's name: its characters are those of `waymark_proto::keys::Id`.
        let path = directory.join(&landmark.id).with_extension(EXTENSION);
        let text = landmark_to_json(landmark)
            .map_err(|source| LandmarkFilesError::Content { path: path.clone(), source: Box::new(source) })?;
        fs::write(&path, text).map_err(|source| io(&path, source))?;
        written.push(path);
    }
    Ok(written)
}

fn files_in(directory: &Path) -> Result<Vec<PathBuf>, LandmarkFilesError> {
    let mut files = Vec::new();
    for entry in fs::read_dir(directory).map_err(|source| io(directory, source))? {
        let path = entry.map_err(|source| io(directory, source))?.path();
        if path.extension().is_some_and(|extension| extension == EXTENSION) {
            files.push(path);
        }
    }
    if files.is_empty() {
        return Err(LandmarkFilesError::Empty { path: directory.to_owned() });
    }
    files.sort();
    Ok(files)
}

fn io(path: &Path, source: std::io::Error) -> LandmarkFilesError {
    LandmarkFilesError::Io { path: path.to_owned(), source }
}
