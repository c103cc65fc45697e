//! A disk in memory that can be full, broken or read-only.

use std::{
    collections::BTreeMap,
    io,
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard},
};

use super::{RecordingFile, Space, Storage, Stored};
use crate::{FileName, file_name::FINISHED};

/// A handle on the disk; clones share it, so that a test can break what the recorder uses.
#[derive(Debug, Clone)]
pub(crate) struct FaultyDisk(Arc<Mutex<Platter>>);

#[derive(Debug)]
pub(crate) struct Platter {
    pub(crate) files: BTreeMap<String, Vec<u8>>,
    pub(crate) capacity_bytes: u64,
    /// Answered to everything that writes.
    pub(crate) read_only: bool,
    /// Answered to the next syncs.
    pub(crate) syncs_fail: bool,
    pub(crate) syncs: u64,
}

#[derive(Debug)]
pub(crate) struct FaultyFile {
    disk: FaultyDisk,
    name: String,
}

impl FaultyDisk {
    pub(crate) fn new(capacity_bytes: u64) -> Self {
        let files = BTreeMap::new();
        let platter = Platter { files, capacity_bytes, read_only: false, syncs_fail: false, syncs: 0 };
        Self(Arc::new(Mutex::new(platter)))
    }

    pub(crate) fn platter(&self) -> MutexGuard<'_, Platter> {
        self.0.lock().unwrap()
    }
}

impl Platter {
    fn free_bytes(&self) -> u64 {
        self.capacity_bytes - self.files.values().map(|content| content.len() as u64).sum::<u64>()
    }
}

impl RecordingFile for FaultyFile {
    fn write_at(&self, bytes: &[u8], offset: u64) -> io::Result<usize> {
        let mut platter = self.disk.platter();
        let free_bytes = platter.free_bytes() as usize;
        let content = platter.files.get_mut(&self.name).ok_or(io::ErrorKind::NotFound)?;
        let offset = offset as usize;
        let fits = bytes.len().min(content.len() + free_bytes - offset);
        content.resize(content.len().max(offset + fits), 0);
        content[offset..offset + fits].copy_from_slice(&bytes[..fits]);
        if fits == 0 && !bytes.is_empty() { Err(io::ErrorKind::StorageFull.into()) } else { Ok(fits) }
    }

    fn sync(&self) -> io::Result<()> {
        let mut platter = self.disk.platter();
        platter.syncs += 1;
        if platter.syncs_fail { Err(io::Error::other("bad sector")) } else { Ok(()) }
    }

    fn truncate(&self, length: u64) -> io::Result<()> {
        let mut platter = self.disk.platter();
        platter.files.get_mut(&self.name).ok_or(io::ErrorKind::NotFound)?.truncate(length as usize);
        Ok(())
    }
}

impl Storage for FaultyDisk {
    type File = FaultyFile;

    fn create_new(&mut self, name: &str) -> io::Result<FaultyFile> {
        let mut platter = self.platter();
        if platter.read_only {
            return Err(io::ErrorKind::ReadOnlyFilesystem.into());
        }
        if platter.files.contains_key(name) {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        platter.files.insert(name.to_owned(), Vec::new());
        drop(platter);
        Ok(FaultyFile { disk: self.clone(), name: name.to_owned() })
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        let mut platter = self.platter();
        let content = platter.files.remove(from).ok_or(io::ErrorKind::NotFound)?;
        assert!(platter.files.insert(to.to_owned(), content).is_none(), "{to} was overwritten");
        Ok(())
    }

    fn remove(&mut self, name: &str) -> io::Result<()> {
        self.platter().files.remove(name).map(drop).ok_or(io::ErrorKind::NotFound.into())
    }

    fn space(&self) -> io::Result<Space> {
        let platter = self.platter();
        Ok(Space { free_bytes: platter.free_bytes(), total_bytes: platter.capacity_bytes })
    }

    fn names(&self) -> io::Result<Vec<String>> {
        Ok(self.platter().files.keys().cloned().collect())
    }

    fn finished(&self, vehicle: &str) -> io::Result<Vec<Stored>> {
        let platter = self.platter();
        let finished = platter.files.iter().filter(|(name, _)| name.ends_with(FINISHED));
        let stored = |(name, content): (&String, &Vec<u8>)| {
            let name = FileName::parse(name).filter(|name| name.vehicle == vehicle)?;
            Some(Stored { name, bytes: content.len() as u64 })
        };
        let mut stored: Vec<_> = finished.filter_map(stored).collect();
        stored.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(stored)
    }

    fn path(&self, name: &str) -> PathBuf {
        PathBuf::from(name)
    }
}
