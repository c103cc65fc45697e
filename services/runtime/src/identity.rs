//! Who this process is: its instance, its machine, and since when it runs.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use uuid::Uuid;

const MACHINE_ID_FILE: &str = "machine-id";
const LOCK_FILE: &str = "in-use";

/// Who this process is.
#[derive(Clone, Debug)]
pub struct Identity {
    /// Drawn at start: names this process among those of its vehicle and role. 32 hexadecimal digits.
    pub instance: String,
    /// Persisted: the same for every start with the same state directory.
    pub machine: String,
    /// Wall clock at start, ns since the Unix epoch.
    pub started_at_ns: i64,
    started: Instant,
}

impl Identity {
    /// A new instance on the machine that `state` belongs to.
    #[must_use]
    pub fn on(state: &StateDir) -> Self {
        Self {
            instance: Uuid::new_v4().simple().to_string(),
            machine: state.machine.clone(),
            started_at_ns: unix_time_ns(),
            started: Instant::now(),
        }
    }

    /// How long this process has been running; unmoved by changes of the wall clock.
    #[must_use]
    pub fn uptime(&self) -> Duration {
        self.started.elapsed()
    }
}

/// The wall clock, ns since the Unix epoch; 0 before it, and the latest instant that fits after 2262.
#[must_use]
pub fn unix_time_ns() -> i64 {
    let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since_epoch.as_nanos()).unwrap_or(i64::MAX)
}

/// A directory that keeps a service's state from one start to the next, held by one process at a time.
#[derive(Debug)]
pub struct StateDir {
    path: PathBuf,
    machine: String,
    /// The kernel releases it when the process ends, however it ends.
    _lock: File,
}

/// Why a state directory cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StateDirError {
    /// Another process holds it.
    #[error(
        "the state directory {path} is in use by {holder}: stop that one, or give this one another directory"
    )]
    InUse {
        /// The directory.
        path: PathBuf,
        /// What the other process wrote about itself.
        holder: String,
    },
    /// It cannot be made, read or written.
    #[error("the state directory's {path}: {source}; give a directory that this user may write to")]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
}

impl StateDir {
    /// Takes hold of `path`, which is made when it does not exist.
    ///
    /// # Errors
    /// When another process holds it, or it cannot be written.
    pub fn open(path: &Path) -> Result<Self, StateDirError> {
        fs::create_dir_all(path).map_err(|source| StateDirError::Io { path: path.to_owned(), source })?;
        let lock = Self::lock(path)?;
        let machine_file = path.join(MACHINE_ID_FILE);
        let machine = machine_id(&machine_file)
            .map_err(|source| StateDirError::Io { path: machine_file.clone(), source })?;
        Ok(Self { path: path.to_owned(), machine, _lock: lock })
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file so that a reader finds the old content or the new one, never a part, also after a power cut.
    ///
    /// # Errors
    /// When the disk is full or not writable; the old content is then untouched.
    pub fn replace(&self, name: &str, content: &[u8]) -> io::Result<()> {
        replace_file(&self.path.join(name), content)
    }

    /// Reads a file; `None` when there is none.
    ///
    /// # Errors
    /// When there is one and it cannot be read.
    pub fn read(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        match fs::read(self.path.join(name)) {
            Ok(content) => Ok(Some(content)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn lock(path: &Path) -> Result<File, StateDirError> {
        let lock_file = path.join(LOCK_FILE);
        let failed = |source| StateDirError::Io { path: lock_file.clone(), source };
        let mut lock = OpenOptions::new()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(&lock_file)
            .map_err(failed)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                lock.read_to_string(&mut holder).map_err(failed)?;
                return Err(StateDirError::InUse { path: path.to_owned(), holder });
            }
            Err(TryLockError::Error(source)) => return Err(failed(source)),
        }
        let content = format!("process {}", std::process::id());
        lock.set_len(0)
            .and_then(|()| lock.rewind())
            .and_then(|()| lock.write_all(content.as_bytes()))
            .map_err(failed)?;
        Ok(lock)
    }
}

/// Writes beside the file, syncs, and renames over it.
fn replace_file(path: &Path, content: &[u8]) -> io::Result<()> {
    let beside = path.with_extension("new");
    let mut file = File::create(&beside)?;
    file.write_all(content)?;
    file.sync_all()?;
    fs::rename(&beside, path)?;
    match path.parent() {
        Some(directory) => File::open(directory)?.sync_all(),
        None => Ok(()),
    }
}

fn machine_id(path: &Path) -> io::Result<String> {
    match fs::read_to_string(path) {
        Ok(text) if Uuid::try_parse(text.trim()).is_ok() => return Ok(text.trim().to_owned()),
        Ok(_) => tracing::warn!(path = %path.display(), "no machine id in there: drawing a new one"),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    let drawn = Uuid::new_v4().simple().to_string();
    replace_file(path, drawn.as_bytes())?;
    Ok(drawn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_machine_stays_and_the_instance_changes() {
        let place = tempfile::tempdir().unwrap();
        let state = StateDir::open(&place.path().join("state")).unwrap();
        let (first, second) = (Identity::on(&state), Identity::on(&state));
        assert_eq!(first.machine, second.machine);
        assert_ne!(first.instance, second.instance);
        drop(state);
        let again = StateDir::open(&place.path().join("state")).unwrap();
        assert_eq!(Identity::on(&again).machine, first.machine);
    }

    #[test]
    fn a_directory_has_one_holder_who_is_named() {
        let place = tempfile::tempdir().unwrap();
        let held = StateDir::open(place.path()).unwrap();
        let refused = StateDir::open(place.path()).unwrap_err();
        assert!(matches!(refused, StateDirError::InUse { .. }));
        assert!(refused.to_string().contains(&format!("process {}", std::process::id())), "{refused}");
        drop(held);
        StateDir::open(place.path()).unwrap();
    }

    #[test]
    fn a_damaged_machine_id_is_replaced() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join(MACHINE_ID_FILE), "\0\0\0").unwrap();
        let drawn = Identity::on(&StateDir::open(place.path()).unwrap()).machine;
        assert_eq!(Identity::on(&StateDir::open(place.path()).unwrap()).machine, drawn);
    }

    #[test]
    fn files_are_replaced_whole() {
        let place = tempfile::tempdir().unwrap();
        let state = StateDir::open(place.path()).unwrap();
        assert_eq!(state.read("epoch").unwrap(), None);
        state.replace("epoch", b"41").unwrap();
        state.replace("epoch", b"42").unwrap();
        assert_eq!(state.read("epoch").unwrap().as_deref(), Some(b"42".as_slice()));
        assert!(!place.path().join("epoch.new").exists());
    }
}
