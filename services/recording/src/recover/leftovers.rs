//! Start-up recovery: files that a crash left behind.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use super::{RecoverReport, recover};
use crate::{
    RecordingError, WriterOptions,
    file_name::{ACTIVE, FINISHED, STARTING},
    storage::rename_new,
    walk::{CutChunk, FaultKind, Step, Walk},
};

/// Extension of a file that recovery is writing.
const RECOVERING: &str = ".recovering";
/// Extension of the original when recovery had to leave out more than a cut end.
const DAMAGED: &str = ".damaged";

/// What start-up recovery did with one `.active` file.
#[derive(Debug)]
pub enum Leftover {
    /// It was complete: only its renaming was missing.
    Renamed(PathBuf),
    /// It was cut; the recovered file has its final name. The original is deleted, or kept as
    /// `NAME.mcap.damaged` when whole chunks of it were damaged.
    Recovered(RecoverReport),
    /// It could not be recovered and stays as it is.
    Left(PathBuf, RecordingError),
}

/// The `.active` files whose writer is gone, locked so that nobody else takes them up.
#[derive(Debug)]
pub struct Leftovers {
    directory: PathBuf,
    actives: Vec<(PathBuf, File)>,
}

impl Leftovers {
    /// Finds and locks them, and clears away files that were never begun. Quick, so that it can be done before
    /// a journal begins its own file there; a live writer's files are locked and left alone.
    pub fn claim(directory: &Path) -> Result<Self, RecordingError> {
        let mut actives = Vec::new();
        for path in paths_in(directory).map_err(RecordingError::io("cannot list", directory))? {
            let name = path.to_string_lossy();
            if name.ends_with(ACTIVE) {
                actives.extend(lock(&path).map(|lock| (path, lock)));
            } else if [RECOVERING, STARTING].iter().any(|extension| name.ends_with(extension)) {
                remove_unlocked(&path)?;
            }
        }
        actives.sort_by(|(a, _), (b, _)| a.cmp(b));
        Ok(Self { directory: directory.to_owned(), actives })
    }

    /// Whether there is anything to recover.
    pub fn is_empty(&self) -> bool {
        self.actives.is_empty()
    }

    /// Recovers them, reading each in full.
    pub fn recover(self, options: &WriterOptions) -> Vec<Leftover> {
        let recover = |(path, _lock): (PathBuf, File)| {
            recover_one(&path, &self.directory, options).unwrap_or_else(|error| Leftover::Left(path, error))
        };
        self.actives.into_iter().map(recover).collect()
    }
}

/// Recovers every `.active` file in `directory` whose writer is gone.
pub fn recover_directory(directory: &Path, options: &WriterOptions) -> Result<Vec<Leftover>, RecordingError> {
    Ok(Leftovers::claim(directory)?.recover(options))
}

fn paths_in(directory: &Path) -> io::Result<Vec<PathBuf>> {
    match fs::read_dir(directory) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        entries => entries?.map(|entry| Ok(entry?.path())).collect(),
    }
}

/// Locks the file unless its writer still does.
fn lock(path: &Path) -> Option<File> {
    let file = File::open(path).ok()?;
    file.try_lock().ok().map(|()| file)
}

fn remove_unlocked(path: &Path) -> Result<(), RecordingError> {
    match lock(path) {
        Some(_locked) => fs::remove_file(path).map_err(RecordingError::io("cannot delete", path)),
        None => Ok(()),
    }
}

fn recover_one(active: &Path, directory: &Path, options: &WriterOptions) -> Result<Leftover, RecordingError> {
    let name = active.to_string_lossy();
    let finished = PathBuf::from(format!("{}{FINISHED}", name.strip_suffix(ACTIVE).unwrap_or(&name)));
    if is_complete(active)? {
        rename(active, &finished, directory)?;
        return Ok(Leftover::Renamed(finished));
    }
    let recovering = PathBuf::from(format!("{}{RECOVERING}", finished.display()));
    let report = recover(active, &recovering, options)?;
    rename(&recovering, &finished, directory)?;
    if report.faults.iter().all(|fault| fault.kind == FaultKind::Cut) {
        fs::remove_file(active).map_err(RecordingError::io("cannot delete", active))?;
    } else {
        // Somebody may know how to get more out of a damaged chunk.
        rename(active, &PathBuf::from(format!("{}{DAMAGED}", finished.display())), directory)?;
    }
    Ok(Leftover::Recovered(RecoverReport { output: finished, ..report }))
}

fn is_complete(path: &Path) -> Result<bool, RecordingError> {
    let mut walk = Walk::open(path, CutChunk::Skip)?;
    while let Some((_, step)) = walk.next_step()? {
        if matches!(step, Step::Fault(_)) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Renames without overwriting, durably.
fn rename(from: &Path, to: &Path, directory: &Path) -> Result<(), RecordingError> {
    rename_new(from, to).map_err(RecordingError::io("cannot rename", from))?;
    let synced = File::open(directory).and_then(|directory| directory.sync_all());
    synced.map_err(RecordingError::io("cannot sync", directory))
}
