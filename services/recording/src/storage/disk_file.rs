//! A file on a real disk, written past the page cache where the file system allows it.
//!
//! What is recorded is not read again soon. Written the ordinary way it is copied into the page cache, and each of its
//! pages is looked for, locked, submitted and released again when the file is synced; all of that is saved. But each
//! write waits for the disk, so that what arrives meanwhile is in this process's memory alone; where others keep the
//! disk busy, chunks go into the page cache instead, which survives the process, and to the disk many at a time.

use std::{
    fs::File,
    io,
    os::unix::fs::{FileExt, OpenOptionsExt},
    path::Path,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use rustix::{fs::OFlags, io::Errno};

use super::RecordingFile;

/// What is written past the page cache is a multiple of this and lies at a multiple of it, in memory and in the file;
/// enough for the disks and file systems of the day, and for the others there is the ordinary way.
pub(crate) const BLOCK_BYTES: usize = 4096;

/// A write that takes longer than this has met a busy disk; idle ones take a few milliseconds for a chunk.
const SLOW_WRITE: Duration = Duration::from_millis(25);

/// How long a disk that was busy is given before a write waits for it again.
const BUSY_FOR: Duration = Duration::from_secs(5);

/// A file being written on a [`super::Disk`].
#[derive(Debug)]
pub struct DiskFile {
    ordinary: File,
    /// The same file, opened `O_DIRECT`.
    direct: Option<File>,
    /// The file system took the flag, but not the writes.
    direct_refused: AtomicBool,
    /// Until when the disk counts as busy.
    busy_until: Mutex<Option<Instant>>,
}

impl DiskFile {
    /// Creates the file `path`, locked until it is closed.
    pub(super) fn create_locked(path: &Path) -> io::Result<Self> {
        let ordinary = File::options().write(true).create_new(true).open(path)?;
        ordinary.try_lock().map_err(io::Error::from)?;
        // Refused by file systems in memory, among others.
        let direct = File::options().write(true).custom_flags(OFlags::DIRECT.bits() as i32).open(path).ok();
        Ok(Self { ordinary, direct, direct_refused: AtomicBool::new(false), busy_until: Mutex::default() })
    }

    /// Writes past the page cache; `None` where that cannot be done.
    fn write_direct(&self, blocks: &[u8], offset: u64) -> Option<io::Result<usize>> {
        let direct = self.direct.as_ref().filter(|_| !self.direct_refused.load(Ordering::Relaxed))?;
        let mut busy_until = self.busy_until.lock().unwrap_or_else(PoisonError::into_inner);
        let begun = Instant::now();
        if busy_until.is_some_and(|until| begun < until) {
            return None;
        }
        let written = direct.write_at(blocks, offset);
        *busy_until = (begun.elapsed() > SLOW_WRITE).then(|| Instant::now() + BUSY_FOR);
        match written {
            Err(error) if Errno::from_io_error(&error) == Some(Errno::INVAL) => {
                self.direct_refused.store(true, Ordering::Relaxed);
                None
            }
            written => Some(written),
        }
    }
}

impl RecordingFile for DiskFile {
    fn write_at(&self, bytes: &[u8], offset: u64) -> io::Result<usize> {
        let directly = whole_blocks(bytes, offset).and_then(|blocks| self.write_direct(blocks, offset));
        directly.unwrap_or_else(|| self.ordinary.write_at(bytes, offset))
    }

    fn sync(&self) -> io::Result<()> {
        self.ordinary.sync_data()
    }

    fn truncate(&self, length: u64) -> io::Result<()> {
        self.ordinary.set_len(length)
    }
}

/// The part of `bytes` that may be written past the page cache at `offset`.
fn whole_blocks(bytes: &[u8], offset: u64) -> Option<&[u8]> {
    let aligned = offset.is_multiple_of(BLOCK_BYTES as u64) && bytes.as_ptr().align_offset(BLOCK_BYTES) == 0;
    let whole = bytes.len() - bytes.len() % BLOCK_BYTES;
    (aligned && whole > 0).then(|| &bytes[..whole])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two whole blocks and a rest, the first byte at a block's beginning in memory.
    fn aligned(memory: &mut Vec<u8>) -> &[u8] {
        memory.resize(4 * BLOCK_BYTES, 7);
        let first = memory.as_ptr().align_offset(BLOCK_BYTES);
        &memory[first..first + 2 * BLOCK_BYTES + 5]
    }

    #[test]
    fn only_whole_blocks_in_their_places_go_past_the_cache() {
        let mut memory = Vec::new();
        let bytes = aligned(&mut memory);
        assert_eq!(whole_blocks(bytes, 0).map(<[u8]>::len), Some(2 * BLOCK_BYTES));
        assert_eq!(whole_blocks(bytes, 8 * BLOCK_BYTES as u64).map(<[u8]>::len), Some(2 * BLOCK_BYTES));
        assert_eq!(whole_blocks(bytes, 1), None);
        assert_eq!(whole_blocks(&bytes[1..], 0), None);
        assert_eq!(whole_blocks(&bytes[..BLOCK_BYTES - 1], 0), None);
    }

    #[test]
    fn a_refusal_costs_nothing_but_the_way() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("recording");
        let file = DiskFile::create_locked(&path).unwrap();
        let mut memory = Vec::new();
        let bytes = aligned(&mut memory);
        // From an odd place in memory, which a real disk refuses and a file system in memory does not mind.
        let odd = file.write_direct(&bytes[1..1 + BLOCK_BYTES], 0);
        assert!(odd.is_none_or(|written| written.is_ok_and(|bytes| bytes == BLOCK_BYTES)));
        let mut written = 0;
        while written < bytes.len() {
            written += file.write_at(&bytes[written..], written as u64).unwrap();
        }
        file.sync().unwrap();
        assert_eq!(std::fs::read(path).unwrap(), bytes);
    }
}
