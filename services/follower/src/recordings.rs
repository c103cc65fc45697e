//! The recordings of a vehicle, as its web face shows them.

mod frame;
mod landmarks;
mod listing;
mod recent;
mod registrations;
mod topics;
mod web;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use recording::FileName;
use recording::timeline::Timeline;
use vision::Landmark;

use recent::Recent;
pub(crate) use web::routes;

/// The directory that the recorder writes to.
#[derive(Debug)]
pub(crate) struct Shelf {
    directory: PathBuf,
    timelines: Recent<Timeline>,
    landmarks: Recent<Vec<Arc<Landmark>>>,
}

/// A recording that is there.
#[derive(Clone, Debug)]
struct Found {
    name: FileName,
    path: PathBuf,
    is_finished: bool,
    bytes: u64,
    /// Changes with the content.
    tag: String,
}

impl Shelf {
    pub(crate) fn new(directory: &Path) -> Self {
        Self { directory: directory.to_owned(), timelines: Recent::default(), landmarks: Recent::default() }
    }

    /// The recording that is called `name` once it is finished. Names are only ever looked up in the directory itself:
    /// what is no recording's name is not there, and neither is what a link points to.
    fn find(&self, name: &str) -> io::Result<Option<Found>> {
        let Some(parsed) = FileName::parse(name).filter(|parsed| parsed.finished() == name) else {
            return Ok(None);
        };
        for (file, is_finished) in [(parsed.finished(), true), (parsed.active(), false)] {
            if let Some(found) = self.found(&parsed, &file, is_finished)? {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    fn found(&self, name: &FileName, file: &str, is_finished: bool) -> io::Result<Option<Found>> {
        let path = self.directory.join(file);
        let metadata = match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            metadata => metadata?,
        };
        if !metadata.is_file() {
            return Ok(None);
        }
        let changed = metadata.modified()?.duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
        let tag = format!("\"{:x}-{:x}\"", metadata.len(), changed.as_nanos());
        Ok(Some(Found { name: name.clone(), path, is_finished, bytes: metadata.len(), tag }))
    }

    /// Every recording, newest first; of several vehicles in one directory by vehicle.
    fn all(&self) -> io::Result<Vec<Found>> {
        let entries = match fs::read_dir(&self.directory) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let mut all = Vec::new();
        for entry in entries {
            let Ok(file) = entry?.file_name().into_string() else { continue };
            let Some(name) = FileName::parse(&file) else { continue };
            // One that vanishes meanwhile was deleted.
            all.extend(self.found(&name, &file, file == name.finished())?);
        }
        all.sort_by(|one, other| other.name.cmp(&one.name));
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAME: &str = "car-20240301T000000Z-0001.mcap";

    #[test]
    fn only_recordings_in_the_directory_itself_are_found() {
        let place = tempfile::tempdir().unwrap();
        let directory = place.path().join("recordings");
        let shelf = Shelf::new(&directory);
        assert!(shelf.all().unwrap().is_empty() && shelf.find(NAME).unwrap().is_none());
        fs::create_dir(&directory).unwrap();
        fs::write(place.path().join(NAME), "outside").unwrap();
        std::os::unix::fs::symlink(place.path().join(NAME), directory.join(NAME)).unwrap();
        fs::write(directory.join("notes.txt"), "").unwrap();
        let traversal = format!("../{NAME}");
        for name in [NAME, &traversal, "notes.txt", "car-20240301T000000Z-1.mcap", "a\0b", "", ".", ".."] {
            assert!(shelf.find(name).unwrap().is_none(), "{name:?}");
        }
        assert!(shelf.all().unwrap().is_empty());
    }

    #[test]
    fn a_recording_keeps_its_name_while_it_is_written() {
        let place = tempfile::tempdir().unwrap();
        let shelf = Shelf::new(place.path());
        let active = place.path().join(format!("{NAME}.active"));
        fs::write(&active, "12").unwrap();
        let written = shelf.find(NAME).unwrap().unwrap();
        assert!(!written.is_finished && written.bytes == 2);
        fs::rename(&active, place.path().join(NAME)).unwrap();
        assert!(shelf.find(NAME).unwrap().unwrap().is_finished);
        assert_eq!(shelf.all().unwrap().len(), 1);
    }
}
