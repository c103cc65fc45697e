//! Opening, closing and giving up files; making room for them.

use std::io;

use super::{Now, OpenFile, Phase, RETRY_EVERY, Recorder, Seam, SnapshotSchedule};
use crate::{FileName, FileWriter, Ledger, RecordingError, Storage, writer::Purpose};

/// Names tried before giving up, should other writers keep taking them.
const NAME_ATTEMPTS: u64 = 100;

impl<S: Storage> Recorder<S> {
    /// Begins a new file whose head is stamped `head_log_time_ns`, or fails until the next retry.
    pub(super) fn reopen(&mut self, head_log_time_ns: u64, now: Now) {
        // A failed recorder waits for more room than it stopped at, or it would flap.
        let margin_bytes = match self.phase {
            Phase::Failed { .. } => 2 * self.options.writer.chunk_bytes as u64,
            _ => 0,
        };
        match self.ensure_room(margin_bytes).and_then(|()| self.open(head_log_time_ns, now)) {
            Ok(file) => self.phase = Phase::Recording(Box::new(file)),
            Err(error) => self.fail(&error, now),
        }
    }

    /// Finishes the open file, if there is one. Afterwards the recorder is off, or failed.
    pub(super) fn close(&mut self, now: Now) {
        let Some(mut file) = self.take_open() else { return };
        if let Err(error) = file.writer.finish(&self.untold) {
            self.phase = Phase::Recording(file);
            return self.fail(&error, now);
        }
        let (active, finished) = (file.name.active(), file.name.finished());
        self.untold = Ledger::default();
        self.settled.add(file.writer.stored());
        self.files_finished += 1;
        let bytes = file.writer.bytes();
        if let Err(source) = self.storage.rename(&active, &finished) {
            self.last_file = Some((active.clone(), bytes));
            let error = RecordingError::io("cannot rename", self.storage.path(&active))(source);
            return self.fail(&error, now);
        }
        self.last_file = Some((finished, bytes));
    }

    /// Goes to the failed state; an open file is cut to what is safe and left for recovery.
    pub(super) fn fail(&mut self, error: &RecordingError, now: Now) {
        let open = self.take_open();
        self.phase = Phase::Failed { reason: error.to_string(), retry_at: now.elapsed + RETRY_EVERY };
        let Some(OpenFile { writer, name, .. }) = open.map(|file| *file) else { return };
        let bytes = writer.bytes();
        let abandoned = writer.abandon();
        self.settled.add(&abandoned.stored);
        self.settled.add(&abandoned.lost);
        self.untold.add(&abandoned.lost);
        if abandoned.stored.total().stored == 0 {
            // A head alone is worth nothing, and would be left again at every retry.
            let _ = self.storage.remove(&name.active());
        } else {
            self.last_file = Some((name.active(), bytes));
        }
    }

    /// Takes the open file out; without one the phase stays as it is.
    fn take_open(&mut self) -> Option<Box<OpenFile<S::File>>> {
        match std::mem::replace(&mut self.phase, Phase::Off) {
            Phase::Recording(file) => Some(file),
            other => {
                self.phase = other;
                None
            }
        }
    }

    /// Deletes old files as far as allowed and needed; fails when there is still too little room.
    pub(super) fn ensure_room(&mut self, margin_bytes: u64) -> Result<(), RecordingError> {
        if let Some(retention) = self.options.retention {
            self.delete_oldest(retention.max_total_bytes, margin_bytes)?;
        }
        let (free_bytes, floor_bytes) = self.free_and_floor()?;
        let needed_bytes = floor_bytes + margin_bytes;
        if free_bytes < needed_bytes {
            Err(RecordingError::NoRoom { free_bytes, needed_bytes })
        } else {
            Ok(())
        }
    }

    fn delete_oldest(&mut self, max_total_bytes: u64, margin_bytes: u64) -> Result<(), RecordingError> {
        let directory = self.storage.path("");
        let oldest_first = self
            .storage
            .finished(&self.options.vehicle)
            .map_err(RecordingError::io("cannot list", directory))?;
        let mut total_bytes: u64 = oldest_first.iter().map(|file| file.bytes).sum();
        for file in oldest_first {
            let (free_bytes, floor_bytes) = self.free_and_floor()?;
            if total_bytes <= max_total_bytes && free_bytes >= floor_bytes + margin_bytes {
                break;
            }
            let name = file.name.finished();
            self.storage
                .remove(&name)
                .map_err(RecordingError::io("cannot delete", self.storage.path(&name)))?;
            total_bytes -= file.bytes;
        }
        Ok(())
    }

    /// Free bytes and the floor in force, which a small file system lowers.
    fn free_and_floor(&mut self) -> Result<(u64, u64), RecordingError> {
        let space = self.storage.space().map_err(|source| {
            RecordingError::io("cannot read free space of", self.storage.path(""))(source)
        })?;
        self.free_bytes = Some(space.free_bytes);
        Ok((space.free_bytes, self.options.free_floor_bytes.min(space.total_bytes / 20)))
    }

    fn open(&mut self, head_log_time_ns: u64, now: Now) -> Result<OpenFile<S::File>, RecordingError> {
        let (name, file) = self.create(now)?;
        let begun = FileWriter::begin(file, &self.options.writer)
            .and_then(|mut writer| self.write_head(&mut writer, head_log_time_ns).map(|()| writer));
        match begun {
            Ok(writer) => Ok(OpenFile {
                writer,
                name,
                opened_at: now.elapsed,
                sync_due: None,
                snapshots: SnapshotSchedule::default(),
                seam: Seam::default(),
            }),
            Err(error) => {
                let _ = self.storage.remove(&name.active());
                Err(error)
            }
        }
    }

    /// Creates a file under a name that no recording has or had a moment ago.
    fn create(&mut self, now: Now) -> Result<(FileName, S::File), RecordingError> {
        let directory = self.storage.path("");
        let names = self.storage.names().map_err(RecordingError::io("cannot list", directory))?;
        let ours = names.iter().filter_map(|name| FileName::parse(name));
        let highest = ours.filter(|name| name.vehicle == self.options.vehicle).map(|name| name.number).max();
        let first = highest.map_or(1, |number| number.saturating_add(1));
        for number in first..first.saturating_add(NAME_ATTEMPTS) {
            let name = FileName::new(&self.options.vehicle, now.unix_ns, number);
            match self.storage.create_new(&name.active()) {
                Ok(file) => return Ok((name, file)),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => {
                    return Err(RecordingError::io("cannot create", self.storage.path(&name.active()))(
                        error,
                    ));
                }
            }
        }
        Err(RecordingError::NoFreeName(FileName::new(&self.options.vehicle, now.unix_ns, first).finished()))
    }

    /// Metadata, attachments and all latched state: what lets the file stand alone.
    fn write_head(&self, writer: &mut FileWriter<S::File>, log_time_ns: u64) -> Result<(), RecordingError> {
        for (name, entries) in &self.options.metadata {
            writer.write_metadata(name, entries.clone())?;
        }
        for attachment in self.latched.attachments() {
            writer.attach(attachment)?;
        }
        for message in self.latched.messages() {
            writer.write(message, log_time_ns, Purpose::Head)?;
        }
        writer.sync()
    }
}
