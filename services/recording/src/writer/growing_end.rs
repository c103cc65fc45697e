//! The growing end of a file: the open chunk gathers in memory and goes to the file whole, in whole blocks.
//!
//! The MCAP writer goes back to a chunk's header once it knows the chunk's size. Here that means going back in memory:
//! the file itself is only ever continued. It also saves the copy that the writer makes of a chunk where it may not
//! seek.

use std::{
    io::{self, ErrorKind, Seek, SeekFrom, Write},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use crate::{RecordingFile, storage::BLOCK_BYTES};

/// A file and how much of it is written, shared by [`GrowingEnd`], which writes, and the one who syncs and cuts.
pub(super) struct Written<F> {
    pub(super) file: F,
    bytes: AtomicU64,
}

impl<F> Written<F> {
    /// Nothing is written of the empty `file`.
    pub(super) fn new(file: F) -> Self {
        Self { file, bytes: AtomicU64::new(0) }
    }

    /// Length of the file, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }
}

/// What is behind the last whole block of the file. [`Write::flush`] brings all of it into the file, keeps the last
/// block, unless that is whole, to write it again with what follows, and goes on at the end.
pub(super) struct GrowingEnd<F> {
    written: Arc<Written<F>>,
    /// Place of the first byte of `memory` in the file, a multiple of [`BLOCK_BYTES`].
    begins_at: u64,
    memory: AlignedBytes,
    /// Where the next byte goes, in `memory`.
    cursor: usize,
}

impl<F: RecordingFile> GrowingEnd<F> {
    pub(super) fn new(written: Arc<Written<F>>) -> Self {
        Self { written, begins_at: 0, memory: AlignedBytes::default(), cursor: 0 }
    }
}

impl<F: RecordingFile> Write for GrowingEnd<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.memory.put(self.cursor, bytes);
        self.cursor += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let length = self.memory.length;
        let mut to_write = (self.written.bytes() - self.begins_at) as usize;
        if to_write < length && length >= BLOCK_BYTES {
            // From the beginning of the block, so that whole blocks are written.
            to_write = 0;
        }
        while to_write < length {
            let place = self.begins_at + to_write as u64;
            match self.written.file.write_at(&self.memory.as_slice()[to_write..], place) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(bytes) => to_write += bytes,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
            self.written.bytes.fetch_max(self.begins_at + to_write as u64, Ordering::Relaxed);
        }
        let whole = length - length % BLOCK_BYTES;
        self.memory.drop_first(whole);
        self.begins_at += whole as u64;
        self.cursor = self.memory.length;
        Ok(())
    }
}

impl<F: RecordingFile> Seek for GrowingEnd<F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (from, by) = match to {
            SeekFrom::Start(place) => (0, i64::try_from(place).map_err(|_| ErrorKind::InvalidInput)?),
            SeekFrom::Current(by) => (self.begins_at + self.cursor as u64, by),
            SeekFrom::End(by) => (self.begins_at + self.memory.length as u64, by),
        };
        let place = from.checked_add_signed(by).and_then(|place| {
            let in_memory = usize::try_from(place.checked_sub(self.begins_at)?).ok()?;
            (in_memory <= self.memory.length).then_some((place, in_memory))
        });
        let Some((place, in_memory)) = place else { return Err(ErrorKind::NotSeekable.into()) };
        self.cursor = in_memory;
        Ok(place)
    }
}

/// Bytes whose first lies at a multiple of [`BLOCK_BYTES`] in memory, as writing past the page cache demands.
#[derive(Default)]
struct AlignedBytes {
    /// A block longer than what may be used, from `first` on.
    memory: Vec<u8>,
    first: usize,
    length: usize,
}

impl AlignedBytes {
    fn as_slice(&self) -> &[u8] {
        &self.memory[self.first..self.first + self.length]
    }

    /// Puts `bytes` at `at`, over what is there and beyond the end.
    fn put(&mut self, at: usize, bytes: &[u8]) {
        let end = at + bytes.len();
        if self.first + end > self.memory.len() {
            self.grow(end);
        }
        self.memory[self.first + at..self.first + end].copy_from_slice(bytes);
        self.length = self.length.max(end);
    }

    fn drop_first(&mut self, bytes: usize) {
        self.memory.copy_within(self.first + bytes..self.first + self.length, self.first);
        self.length -= bytes;
    }

    fn grow(&mut self, length: usize) {
        let memory = vec![0; length.next_power_of_two().max(BLOCK_BYTES) + BLOCK_BYTES];
        let first = memory.as_ptr().align_offset(BLOCK_BYTES).min(BLOCK_BYTES);
        let mut grown = Self { memory, first, length: self.length };
        grown.memory[first..first + self.length].copy_from_slice(self.as_slice());
        *self = grown;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Storage, storage::faulty::FaultyDisk};

    const NAME: &str = "growing";

    fn growing_on(disk: &mut FaultyDisk) -> GrowingEnd<<FaultyDisk as Storage>::File> {
        GrowingEnd::new(Arc::new(Written::new(disk.create_new(NAME).unwrap())))
    }

    #[derive(Debug, Clone)]
    enum Step {
        Write(usize),
        /// Goes back so far at most, writes over what is there and returns to the end, as is done with a header.
        WriteOver(usize),
        Flush,
    }

    fn step() -> impl Strategy<Value = Step> {
        prop_oneof![
            (0_usize..3 * BLOCK_BYTES).prop_map(Step::Write),
            (0_usize..2 * BLOCK_BYTES).prop_map(Step::WriteOver),
            Just(Step::Flush),
        ]
    }

    proptest! {
        #[test]
        fn the_file_is_what_was_written(steps in prop::collection::vec(step(), 0..40)) {
            let mut disk = FaultyDisk::new(1 << 30);
            let mut growing = growing_on(&mut disk);
            let (mut expected, mut in_memory) = (Vec::new(), 0);
            for (number, step) in steps.into_iter().enumerate() {
                match step {
                    Step::Write(bytes) => {
                        let piece = vec![number as u8 + 1; bytes];
                        growing.write_all(&piece).unwrap();
                        expected.extend(piece);
                        in_memory += bytes;
                    }
                    Step::WriteOver(back) => {
                        let back = back.min(in_memory);
                        let from = expected.len() - back;
                        growing.seek(SeekFrom::Start(from as u64)).unwrap();
                        let header = vec![number as u8 + 101; back.min(31)];
                        growing.write_all(&header).unwrap();
                        expected[from..from + header.len()].copy_from_slice(&header);
                        prop_assert_eq!(growing.seek(SeekFrom::End(0)).unwrap(), expected.len() as u64);
                    }
                    Step::Flush => {
                        growing.flush().unwrap();
                        in_memory = 0;
                        prop_assert_eq!(&disk.platter().files[NAME], &expected);
                    }
                }
                prop_assert_eq!(growing.stream_position().unwrap(), expected.len() as u64);
            }
        }
    }

    #[test]
    fn nothing_before_the_last_block_can_be_changed() {
        let mut disk = FaultyDisk::new(1 << 30);
        let mut growing = growing_on(&mut disk);
        growing.write_all(&[1; 2 * BLOCK_BYTES + 10]).unwrap();
        assert!(growing.seek(SeekFrom::Start(0)).is_ok());
        growing.flush().unwrap();
        assert_eq!(growing.stream_position().unwrap(), 2 * BLOCK_BYTES as u64 + 10);
        assert!(growing.seek(SeekFrom::Start(2 * BLOCK_BYTES as u64 - 1)).is_err());
        assert!(growing.seek(SeekFrom::End(1)).is_err(), "there is nothing to skip to");
        assert!(growing.seek(SeekFrom::Start(2 * BLOCK_BYTES as u64)).is_ok());
    }

    #[test]
    fn after_a_full_disk_writing_goes_on_where_it_stopped() {
        let mut disk = FaultyDisk::new(2 * BLOCK_BYTES as u64 + 100);
        let mut growing = growing_on(&mut disk);
        growing.write_all(&[1; 3 * BLOCK_BYTES]).unwrap();
        assert_eq!(growing.flush().unwrap_err().kind(), ErrorKind::StorageFull);
        assert_eq!(growing.written.bytes(), 2 * BLOCK_BYTES as u64 + 100);
        disk.platter().capacity_bytes *= 2;
        growing.flush().unwrap();
        assert_eq!(disk.platter().files[NAME], [1; 3 * BLOCK_BYTES]);
    }
}
