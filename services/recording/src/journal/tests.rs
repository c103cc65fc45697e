//! The thread and its queue: nothing blocks, everything is counted.

use std::sync::mpsc;

use super::*;
use crate::{
    Latch, Space, State,
    storage::{RecordingFile, Stored, faulty::FaultyDisk},
    testing::{channel, message, names, options, read_strictly, sequences_on},
};

const SOON: Duration = Duration::from_secs(30);

#[test]
fn what_is_offered_is_stored() {
    let directory = tempfile::tempdir().unwrap();
    let journal = Journal::start(options(directory.path())).unwrap();
    let log = channel("/log");
    let accepted = (0..500).map(|n| journal.offer(message(&log, n, 100)));
    assert!(accepted.into_iter().all(|offered| offered == Offered::Accepted));
    let report = journal.finish(SOON);
    assert!(report.in_time);
    let total = report.ledger.total();
    assert_eq!((total.offered, total.stored, total.lost()), (500, 500, 0));
    assert_eq!(report.status.file.as_deref().map(read_strictly).unwrap().len(), 500);
    assert_eq!(journal.offer(message(&log, 500, 1)), Offered::Closed);
    assert!(journal.finish(SOON).in_time, "finishing twice is harmless");
}

#[test]
fn commands_take_effect_between_the_messages_they_were_given_between() {
    let directory = tempfile::tempdir().unwrap();
    let journal = Journal::start(options(directory.path())).unwrap();
    let log = channel("/log");
    let offer = |range: std::ops::Range<u32>| {
        range.for_each(|n| assert_eq!(journal.offer(message(&log, n, 10)), Offered::Accepted));
    };
    offer(0..3);
    journal.command(Command::Split);
    offer(3..5);
    journal.command(Command::Stop);
    offer(5..7);
    journal.command(Command::Start);
    offer(7..8);
    let report = journal.finish(SOON);
    let read = |name: &String| sequences_on(&read_strictly(&directory.path().join(name)), "/log");
    let files: Vec<_> = names(directory.path()).iter().map(read).collect();
    assert_eq!(files, [vec![0, 1, 2], vec![3, 4], vec![7]]);
    let account = report.ledger.total();
    assert_eq!((account.offered, account.stored, account.unrecorded, account.lost()), (8, 6, 2, 0));
}

#[test]
fn the_reserve_keeps_small_messages_when_pictures_no_longer_fit() {
    let bounds = crate::QueueBounds { messages: 1000, bytes: 1 << 20 };
    let queue = Queue::new(bounds);
    let (image, log) = (channel("/image"), channel("/log"));
    let images =
        (0..100).filter(|&n| queue.offer(vec![message(&image, n, 50_000)]) == Offered::Accepted).count();
    assert!((15..20).contains(&images), "{images}");
    assert_eq!(queue.offer(vec![message(&log, 0, 100)]), Offered::Accepted);
    assert_eq!(queue.take(None).refused.get("/image").unwrap().lost_in_queue, 100 - images as u64);
}

#[test]
fn refused_state_is_still_repeated_at_later_heads() {
    let bounds = crate::QueueBounds { messages: 1, bytes: 1 << 20 };
    let queue = Queue::new(bounds);
    let landmark = channel("/landmark");
    let state = |n| crate::testing::latched(&landmark, n, "red");
    assert_eq!(queue.offer(vec![state(0)]), Offered::Accepted);
    assert_eq!(queue.offer(vec![state(1)]), Offered::Refused);
    assert!(matches!(queue.take(None).item, Some(Item::Messages(batch)) if batch[0].sequence == 0));
    assert!(matches!(queue.take(None).item, Some(Item::Keep(kept)) if kept.sequence == 1));
}

/// A disk whose every sync waits for the test.
struct SlowDisk(FaultyDisk, Arc<Mutex<mpsc::Receiver<()>>>);
struct SlowFile(<FaultyDisk as Storage>::File, Arc<Mutex<mpsc::Receiver<()>>>);

impl RecordingFile for SlowFile {
    fn write_at(&self, bytes: &[u8], offset: u64) -> std::io::Result<usize> {
        self.0.write_at(bytes, offset)
    }

    fn sync(&self) -> std::io::Result<()> {
        // Once the test lets go of its end, the disk is fast.
        let _ = self.1.lock().unwrap().recv();
        self.0.sync()
    }

    fn truncate(&self, length: u64) -> std::io::Result<()> {
        self.0.truncate(length)
    }
}

impl Storage for SlowDisk {
    type File = SlowFile;

    fn create_new(&mut self, name: &str) -> std::io::Result<SlowFile> {
        Ok(SlowFile(self.0.create_new(name)?, Arc::clone(&self.1)))
    }

    fn rename(&mut self, from: &str, to: &str) -> std::io::Result<()> {
        self.0.rename(from, to)
    }

    fn remove(&mut self, name: &str) -> std::io::Result<()> {
        self.0.remove(name)
    }

    fn space(&self) -> std::io::Result<Space> {
        self.0.space()
    }

    fn names(&self) -> std::io::Result<Vec<String>> {
        self.0.names()
    }

    fn finished(&self, vehicle: &str) -> std::io::Result<Vec<Stored>> {
        self.0.finished(vehicle)
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path(name)
    }
}

#[test]
fn a_slow_disk_costs_messages_but_never_time_and_every_loss_is_counted() {
    let (disk, (release, gate)) = (FaultyDisk::new(100 << 20), mpsc::sync_channel::<()>(0));
    let mut bounded = options("".as_ref());
    bounded.queue = crate::QueueBounds { messages: 10_000, bytes: 1 << 20 };
    let slow = SlowDisk(disk.clone(), Arc::new(Mutex::new(gate)));
    let journal = Journal::start_on(bounded, slow).unwrap();
    let (image, log) = (channel("/image"), channel("/log"));
    for n in 0..400 {
        let (picture, line) = (message(&image, n, 30_000), message(&log, n, 20));
        // Neither call may wait: the disk answers nothing before the loop is over.
        let _ = (journal.offer(picture), journal.offer(line));
    }
    drop(release);
    let report = journal.finish(SOON);
    assert!(report.in_time);
    let name = disk.names().unwrap().pop().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(&name);
    std::fs::write(&path, &disk.platter().files[&name]).unwrap();
    let read = read_strictly(&path);
    for (topic, account) in report.ledger.iter() {
        assert_eq!(account.offered, 400);
        assert_eq!(account.offered - account.stored, account.lost(), "{topic}");
        assert_eq!(account.stored, sequences_on(&read, topic).len() as u64, "{topic}");
    }
    assert!(report.ledger.get("/image").unwrap().lost() > 300);
    assert_eq!(report.ledger.get("/log").unwrap().lost(), 0, "small messages have the reserve");
}

#[test]
fn a_disk_that_hangs_does_not_hold_up_the_end() {
    let (release, gate) = mpsc::sync_channel::<()>(0);
    let slow = SlowDisk(FaultyDisk::new(1 << 20), Arc::new(Mutex::new(gate)));
    let journal = Journal::start_on(options("".as_ref()), slow).unwrap();
    journal.offer(message(&channel("/log"), 0, 10));
    assert!(!journal.finish(Duration::ZERO).in_time);
    drop(release);
    assert!(journal.finish(SOON).in_time);
}

#[test]
fn a_failed_disk_shows_in_the_status() {
    let disk = FaultyDisk::new(1 << 20);
    disk.platter().read_only = true;
    let journal = Journal::start_on(options("".as_ref()), disk).unwrap();
    let message = crate::Message { latch: Latch::None, ..message(&channel("/log"), 0, 10) };
    journal.offer(message);
    let report = journal.finish(SOON);
    assert_eq!((report.status.state, report.status.lost), (State::Failed, 1));
    assert!(report.status.reason.is_some());
}
