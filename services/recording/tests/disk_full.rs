//! A real full disk: a tmpfs of 4 MiB. Needs the right to mount; skipped loudly without.

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

/// A mounted tmpfs that is unmounted in the end.
struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    fn mount() -> Option<Self> {
        let directory = tempfile::tempdir().unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=4m", "waymark-test"]).arg(directory.path());
        let mounted = mount.output().is_ok_and(|output| output.status.success());
        mounted.then_some(Self(directory))
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
    let Some(disk) = SmallDisk::mount() else {
        eprintln!("SKIPPED: no right to mount the 4 MiB tmpfs that this test fills");
        return;
    };
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
