//! Where recordings lie. The trait is the seam at which tests inject full, failing and slow disks.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use rustix::fs::{CWD, RenameFlags};

use crate::file_name::{FINISHED, FileName, STARTING};

mod disk_file;
#[cfg(test)]
pub(crate) mod faulty;

pub(crate) use disk_file::BLOCK_BYTES;
pub use disk_file::DiskFile;

/// Room on a file system, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Space {
    /// Free to us.
    pub free_bytes: u64,
    /// Size of the file system.
    pub total_bytes: u64,
}

/// A file that is being written, from its beginning to its end.
pub trait RecordingFile: Send + Sync {
    /// Writes some of `bytes` at `offset`, which is in the file or at its end, and says how many, as `pwrite` does.
    fn write_at(&self, bytes: &[u8], offset: u64) -> io::Result<usize>;
    /// Makes everything written durable (`fdatasync`).
    fn sync(&self) -> io::Result<()>;
    /// Cuts the file to `length` bytes.
    fn truncate(&self, length: u64) -> io::Result<()>;
}

/// A finished recording in a [`Storage`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stored {
    /// Its name.
    pub name: FileName,
    /// Its size.
    pub bytes: u64,
}

/// A directory of recordings.
pub trait Storage: Send {
    /// What it hands out for writing.
    type File: RecordingFile;

    /// Creates `name` for writing; fails with [`io::ErrorKind::AlreadyExists`] when it is taken.
    fn create_new(&mut self, name: &str) -> io::Result<Self::File>;
    /// Renames without ever overwriting, durably.
    fn rename(&mut self, from: &str, to: &str) -> io::Result<()>;
    /// Deletes a finished recording.
    fn remove(&mut self, name: &str) -> io::Result<()>;
    /// Room left.
    fn space(&self) -> io::Result<Space>;
    /// All names in it.
    fn names(&self) -> io::Result<Vec<String>>;
    /// Finished recordings of `vehicle`, oldest first.
    fn finished(&self, vehicle: &str) -> io::Result<Vec<Stored>>;
    /// Full path of `name`, for people and logs.
    fn path(&self, name: &str) -> PathBuf;
}

/// A directory on a real disk.
#[derive(Debug)]
pub struct Disk {
    directory: PathBuf,
}

impl Disk {
    /// Recordings in `directory`, which is created when first needed.
    pub fn new(directory: impl Into<PathBuf>) -> Self {
        Self { directory: directory.into() }
    }

    /// A new or renamed directory entry is only durable once the directory itself is synced.
    fn sync_directory(&self) -> io::Result<()> {
        fs::File::open(&self.directory)?.sync_all()
    }
}

impl Storage for Disk {
    type File = DiskFile;

    fn create_new(&mut self, name: &str) -> io::Result<DiskFile> {
        fs::create_dir_all(&self.directory)?;
        // Locked until it is closed, so that start-up recovery of another process leaves it alone; it gets its
        // name only then, so that there is no moment in which a recording stands there unlocked.
        let starting = self.path(&format!("{name}{STARTING}"));
        let file = DiskFile::create_locked(&starting)?;
        if let Err(error) = rename_new(&starting, &self.path(name)) {
            let _ = fs::remove_file(&starting);
            return Err(error);
        }
        self.sync_directory()?;
        Ok(file)
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        rename_new(&self.path(from), &self.path(to))?;
        self.sync_directory()
    }

    fn remove(&mut self, name: &str) -> io::Result<()> {
        fs::remove_file(self.path(name))
    }

    fn space(&self) -> io::Result<Space> {
        let existing = self.directory.ancestors().find(|p| p.exists()).unwrap_or(Path::new("."));
        let stat = rustix::fs::statvfs(existing)?;
        Ok(Space {
            free_bytes: stat.f_bavail.saturating_mul(stat.f_frsize),
            total_bytes: stat.f_blocks.saturating_mul(stat.f_frsize),
        })
    }

    fn names(&self) -> io::Result<Vec<String>> {
        let entries = match fs::read_dir(&self.directory) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let names = entries.map(|entry| Ok(entry?.file_name().into_string().ok()));
        names.filter_map(Result::transpose).collect()
    }

    fn finished(&self, vehicle: &str) -> io::Result<Vec<Stored>> {
        let mut stored = Vec::new();
        for file in self.names()? {
            let ours = |name: &FileName| file.ends_with(FINISHED) && name.vehicle == vehicle;
            if let Some(name) = FileName::parse(&file).filter(ours) {
                stored.push(Stored { name, bytes: fs::metadata(self.path(&file))?.len() });
            }
        }
        stored.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(stored)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }
}

/// Renames, refusing to overwrite: in one step where the file system can (`RENAME_NOREPLACE`), else after
/// looking, which is safe enough because every writer also avoids existing names when it creates.
pub(crate) fn rename_new(from: &Path, to: &Path) -> io::Result<()> {
    match rustix::fs::renameat_with(CWD, from, CWD, to, RenameFlags::NOREPLACE) {
        Err(rustix::io::Errno::INVAL | rustix::io::Errno::NOSYS) if !to.exists() => fs::rename(from, to),
        Err(rustix::io::Errno::INVAL | rustix::io::Errno::NOSYS) => Err(io::ErrorKind::AlreadyExists.into()),
        renamed => Ok(renamed?),
    }
}
