//! Real full disks: a tmpfs of 4 MiB, and an ext4 in a file. Needs the right to mount; skipped loudly without.

#![allow(clippy::unwrap_used, reason = "a test ends where its preparation fails")]

use std::{
    path::{Path, PathBuf},
    process::Command,
    sync::Arc,
    time::{Duration, Instant},
};

use bytes::Bytes;
use recording::{
    ChannelSpec, Journal, JournalOptions, Latch, Message, Schema, State, Status,
    reader::{MessageReader, Strictness},
};

/// A mounted file system that is unmounted in the end.
struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    /// In memory.
    fn tmpfs() -> Option<Self> {
        Self::mount(["-t", "tmpfs", "-o", "size=4m", "waymark-test"])
    }

    /// In the file `image`: one that is written past the page cache.
    fn ext4(image: &Path) -> Option<Self> {
        std::fs::File::create(image).unwrap().set_len(6 << 20).unwrap();
        let mut format = Command::new("mkfs.ext4");
        let formatted = format.args(["-q", "-m", "0"]).arg(image).output();
        let formatted = formatted.is_ok_and(|output| output.status.success());
        formatted.then(|| Self::mount(["-t", "ext4", "-o", "loop", image.to_str().unwrap()]))?
    }

    fn mount<'a>(how: impl IntoIterator<Item = &'a str>) -> Option<Self> {
        let directory = tempfile::tempdir().unwrap();
        let mounted = Command::new("mount").args(how).arg(directory.path()).output();
        mounted.is_ok_and(|output| output.status.success()).then_some(Self(directory))
    }

    fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // A tmpfs that cannot be unmounted goes with the machine.
        let _ = Command::new("umount").arg("--lazy").arg(self.0.path()).status();
    }
}

struct Camera {
    journal: Journal,
    channel: Arc<ChannelSpec>,
    sequence: u32,
}

impl Camera {
    /// Offers pictures until `enough`; fails the test when that takes too long.
    fn film_until(&mut self, enough: impl Fn(&Status) -> bool) -> Status {
        let begun = Instant::now();
        loop {
            let status = self.journal.status();
            if enough(&status) {
                return status;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "{status:?}");
            // The queue's bound keeps this from racing ahead of the disk; what it refuses is counted.
            let time_ns = u64::from(self.sequence) + 1;
            let _counted = self.journal.offer(Message {
                channel: Arc::clone(&self.channel),
                log_time_ns: time_ns,
                publish_time_ns: time_ns,
                sequence: self.sequence,
                data: Bytes::from_static(&[0; 20_000]),
                latch: Latch::None,
            });
            self.sequence += 1;
            std::thread::yield_now();
        }
    }
}

fn messages_in(directory: &Path) -> u64 {
    let files = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let recordings = files.filter(|path: &PathBuf| path.to_string_lossy().contains(".mcap"));
    let counts =
        recordings.map(|path| MessageReader::open(&path, Strictness::Lenient).unwrap().count() as u64);
    counts.sum()
}

#[test]
fn a_full_disk_is_survived_and_every_loss_is_counted() {
    match SmallDisk::tmpfs() {
        Some(disk) => fill(&disk),
        None => eprintln!("SKIPPED: no right to mount the 4 MiB tmpfs that this test fills"),
    }
}

#[test]
fn a_full_disk_that_is_written_past_the_page_cache_is_survived_too() {
    let directory = tempfile::tempdir().unwrap();
    match SmallDisk::ext4(&directory.path().join("image")) {
        Some(disk) => fill(&disk),
        None => eprintln!("SKIPPED: no right to mount the 6 MiB ext4 that this test fills, or no mkfs.ext4"),
    }
}

fn fill(disk: &SmallDisk) {
    let ballast = disk.path().join("ballast");
    std::fs::write(&ballast, vec![0; 1 << 20]).unwrap();
    let mut options = JournalOptions::new(disk.path(), "car");
    options.writer.chunk_bytes = 256 << 10;
    options.queue.bytes = 1 << 20;
    let schema = Schema { name: String::new(), file_descriptor_set: Bytes::new() };
    let channel = Arc::new(ChannelSpec { topic: "/image".to_owned(), key_expression: String::new(), schema });
    let mut camera = Camera { journal: Journal::start(options).unwrap(), channel, sequence: 0 };

    let failed = camera.film_until(|status| status.state == State::Failed);
    assert!(failed.reason.is_some_and(|reason| reason.contains("full") || reason.contains("No space")));
    assert!(failed.stored > 100, "most of the disk was used: {}", failed.stored);
    assert!(messages_in(disk.path()) >= failed.stored, "what was flushed is readable");

    std::fs::remove_file(&ballast).unwrap();
    let again = camera.film_until(|status| status.stored > failed.stored);
    assert_ne!(again.file, failed.file, "it goes on in a new file");

    let report = camera.journal.finish(Duration::from_secs(30));
    let total = report.ledger.total();
    assert_eq!(total.offered, u64::from(camera.sequence));
    assert_eq!(total.offered - total.stored, total.lost());
    assert_eq!(messages_in(disk.path()), total.stored, "stored is what is on the disk, exactly");
}
