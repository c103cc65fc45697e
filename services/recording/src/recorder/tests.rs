//! The recorder without thread or clock: self-contained files, rotation, retention, failure, pre-trigger.

use std::{collections::BTreeMap, time::Duration};

use bytes::Bytes;

use crate::{
    Attachment, Command, FileName, JournalOptions, LatchKey, Recorder, Retention, Rotation, State, Storage,
    reader::{MessageReader, Strictness},
    storage::faulty::FaultyDisk,
    testing::{
        at_ms, channel, latched, message, names, options, read_strictly, recorder, sequences_on, snapshot,
    },
    walk::RecordedMessage,
};

fn on_faulty_disk(disk: &FaultyDisk, options: JournalOptions) -> Recorder<FaultyDisk> {
    let mut recorder = Recorder::new(options, disk.clone()).unwrap();
    recorder.command(Command::Start, at_ms(0));
    recorder
}

fn read_platter(disk: &FaultyDisk, name: &str) -> Vec<RecordedMessage> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    std::fs::write(&path, &disk.platter().files[name]).unwrap();
    MessageReader::open(&path, Strictness::Lenient).unwrap().map(Result::unwrap).collect()
}

#[test]
fn a_finished_file_holds_exactly_what_was_stored() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = recorder(options(directory.path()));
    let (image, log) = (channel("/car/camera/front/image"), channel("/log"));
    for n in 0..50 {
        recorder.store(vec![message(&image, n, 60_000), message(&log, n, 80)], at_ms(u64::from(n) * 33));
        recorder.tick(at_ms(u64::from(n) * 33));
    }
    recorder.finish(at_ms(2_000));

    assert_eq!(names(directory.path()), ["car-20240301T000000Z-0001.mcap"]);
    let read = read_strictly(&directory.path().join("car-20240301T000000Z-0001.mcap"));
    assert_eq!(sequences_on(&read, "/log"), (0..50).collect::<Vec<_>>());
    for (n, recorded) in read.iter().filter(|m| m.channel.topic.ends_with("image")).enumerate() {
        let offered = message(&image, n as u32, 60_000);
        assert_eq!(recorded.data, offered.data);
        assert_eq!(
            (recorded.log_time_ns, recorded.publish_time_ns),
            (offered.log_time_ns, offered.publish_time_ns)
        );
        assert_eq!(recorded.channel.metadata["key_expression"], image.key_expression);
    }
    let ledger = recorder.ledger();
    assert_eq!((ledger.total().stored, ledger.total().lost()), (100, 0));
}

#[test]
fn every_rotated_file_stands_alone_and_no_message_is_lost() {
    let directory = tempfile::tempdir().unwrap();
    let rotation = Rotation { max_bytes: 200_000, max_duration: Duration::from_secs(3600) };
    let mut recorder = recorder(JournalOptions { rotation, ..options(directory.path()) });
    let (image, landmark) = (channel("/car/camera/front/image"), channel("/car/landmark"));
    recorder.store(vec![latched(&landmark, 7, "red")], at_ms(0));
    recorder.store(vec![latched(&landmark, 8, "blue")], at_ms(0));
    recorder.store(vec![latched(&landmark, 9, "red")], at_ms(0));
    let data = Bytes::from_static(b"[]");
    let set = Attachment {
        name: "landmarks.json".into(),
        media_type: "application/json".into(),
        log_time_ns: 5,
        data,
    };
    recorder.attach(set.clone(), at_ms(0));
    for n in 0..40 {
        recorder.store(vec![message(&image, n, 20_000)], at_ms(u64::from(n)));
    }
    recorder.forget(LatchKey("blue".into()));
    recorder.command(Command::Split, at_ms(50));
    recorder.finish(at_ms(60));

    let mut images = Vec::new();
    let files = names(directory.path());
    assert_eq!(files.len(), 5, "{files:?}");
    for (index, name) in files.iter().enumerate() {
        let read = read_strictly(&directory.path().join(name));
        let landmarks = match index {
            0 => vec![7, 8, 9],
            4 => vec![9],
            _ => vec![8, 9],
        };
        assert_eq!(sequences_on(&read, "/car/landmark"), landmarks, "{name}");
        let (head, rest) = read.split_at(landmarks.len());
        assert!(head.iter().all(|m| m.channel.topic == "/car/landmark"), "state comes first in {name}");
        if let (1.., Some(first_image)) = (index, rest.first()) {
            assert!(
                head.iter().all(|m| m.log_time_ns == first_image.log_time_ns),
                "stamped with the file's start"
            );
        }
        images.extend(sequences_on(&read, "/car/camera/front/image"));
    }
    assert_eq!(images, (0..40).collect::<Vec<_>>());
    assert_eq!(recorder.ledger().total().stored, 43);
    assert_eq!(recorder.ledger().get("/car/landmark").unwrap().repeated, 2 + 2 + 2 + 1);
}

#[test]
fn messages_that_belong_together_stay_in_one_file() {
    let directory = tempfile::tempdir().unwrap();
    let rotation = Rotation { max_bytes: 30_000, max_duration: Duration::from_secs(3600) };
    let mut recorder = recorder(JournalOptions { rotation, ..options(directory.path()) });
    let (registration, annotations) = (channel("/r"), channel("/a"));
    for n in 0..60 {
        recorder.store(vec![message(&registration, n, 900), message(&annotations, n, 900)], at_ms(0));
    }
    recorder.finish(at_ms(10));
    for name in names(directory.path()) {
        let read = read_strictly(&directory.path().join(&name));
        assert_eq!(sequences_on(&read, "/r"), sequences_on(&read, "/a"), "{name}");
    }
}

#[test]
fn a_snapshot_stands_at_the_head_and_until_it_includes_the_files_first_picture() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = recorder(options(directory.path()));
    let (image, state) = (channel("/image"), channel("/state"));
    let picture = |recorder: &mut Recorder<_>, n| recorder.store(vec![message(&image, n, 50)], at_ms(0));
    let seen = |recorder: &mut Recorder<_>, n| recorder.store(vec![snapshot(&state, n, &image)], at_ms(0));
    for n in 0..5 {
        picture(&mut recorder, n);
        seen(&mut recorder, n);
    }
    // Two pictures are in flight when the file ends.
    (5..7).for_each(|n| picture(&mut recorder, n));
    recorder.command(Command::Split, at_ms(1));
    seen(&mut recorder, 5);
    picture(&mut recorder, 7);
    (6..9).for_each(|n| seen(&mut recorder, n));
    recorder.finish(at_ms(3));

    let files = names(directory.path());
    let states = |name: &String| sequences_on(&read_strictly(&directory.path().join(name)), "/state");
    assert_eq!(files.iter().map(states).collect::<Vec<_>>(), [vec![0], vec![4, 5, 6]]);
    let account = recorder.ledger().get("/state").copied().unwrap();
    assert_eq!((account.stored, account.repeated, account.unrecorded, account.lost()), (3, 1, 6, 0));
}

#[test]
fn a_snapshot_is_stored_again_after_five_seconds() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = recorder(options(directory.path()));
    let (image, state) = (channel("/image"), channel("/state"));
    // A message each millisecond.
    for n in (0..12_000).step_by(100) {
        recorder.store(vec![message(&image, n, 50), snapshot(&state, n, &image)], at_ms(0));
    }
    recorder.finish(at_ms(3));
    let read = read_strictly(&directory.path().join(&names(directory.path())[0]));
    assert_eq!(sequences_on(&read, "/state"), [0, 5_000, 10_000]);
}

#[test]
fn flushing_is_by_the_clock_given() {
    let disk = FaultyDisk::new(10 << 20);
    let mut recorder = on_faulty_disk(&disk, options("".as_ref()));
    let log = channel("/log");
    let after_head = disk.platter().syncs;
    recorder.store(vec![message(&log, 0, 100)], at_ms(1_000));
    assert_eq!(recorder.next_tick(), Some(Duration::from_millis(1_400)));
    recorder.tick(at_ms(1_399));
    assert_eq!((disk.platter().syncs, recorder.ledger().total().stored), (after_head, 0));
    recorder.tick(at_ms(1_400));
    assert_eq!((disk.platter().syncs, recorder.ledger().total().stored), (after_head + 1, 1));
    assert_eq!(recorder.next_tick(), None, "nothing to sync, nothing to wait for");
    let active = disk.names().unwrap();
    assert_eq!(sequences_on(&read_platter(&disk, &active[0]), "/log"), [0], "readable while being written");
}

#[test]
fn a_full_disk_fails_the_recorder_and_room_revives_it() {
    let disk = FaultyDisk::new(1 << 20);
    let mut with_small_chunks = options("".as_ref());
    with_small_chunks.writer.chunk_bytes = 64 << 10;
    let mut recorder = on_faulty_disk(&disk, with_small_chunks);
    let image = channel("/image");
    let mut n = 0;
    while recorder.state() == State::Recording {
        recorder.store(vec![message(&image, n, 20_000)], at_ms(u64::from(n) * 10));
        recorder.tick(at_ms(u64::from(n) * 10));
        n += 1;
        assert!(n < 100, "the disk never filled");
    }
    assert!(recorder.status().reason.unwrap().starts_with("cannot write the recording: "));
    let first = disk.names().unwrap();
    let readable = sequences_on(&read_platter(&disk, &first[0]), "/image");
    let account = recorder.ledger().get("/image").copied().unwrap();
    assert_eq!(account.stored, readable.len() as u64, "what counts as stored is in the file");
    assert_eq!(account.stored + account.lost(), u64::from(n));

    recorder.store(vec![message(&image, n, 20_000)], at_ms(u64::from(n) * 10));
    assert_eq!(recorder.ledger().get("/image").unwrap().lost(), account.lost() + 1, "lost while failed");

    disk.platter().capacity_bytes = 4 << 20;
    recorder.tick(at_ms(60_000));
    assert_eq!(recorder.state(), State::Recording);
    recorder.store(vec![message(&image, n + 1, 20_000)], at_ms(60_001));
    recorder.finish(at_ms(60_002));
    let last = disk.names().unwrap().pop().unwrap();
    assert_eq!(sequences_on(&read_platter(&disk, &last), "/image"), [n + 1]);
    let total = recorder.ledger().total();
    assert_eq!(total.stored + total.lost(), u64::from(n) + 2);
}

#[test]
fn a_sync_that_fails_counts_only_what_was_synced() {
    let disk = FaultyDisk::new(10 << 20);
    let mut recorder = on_faulty_disk(&disk, options("".as_ref()));
    let log = channel("/log");
    recorder.store(vec![message(&log, 0, 100)], at_ms(0));
    recorder.tick(at_ms(400));
    recorder.store(vec![message(&log, 1, 100)], at_ms(500));
    disk.platter().syncs_fail = true;
    recorder.tick(at_ms(900));
    assert_eq!(recorder.state(), State::Failed);
    let active = disk.names().unwrap();
    assert_eq!(sequences_on(&read_platter(&disk, &active[0]), "/log"), [0]);
    assert_eq!((recorder.ledger().total().stored, recorder.ledger().total().lost()), (1, 1));
}

#[test]
fn a_read_only_directory_fails_with_a_reason_and_leaves_nothing() {
    let disk = FaultyDisk::new(10 << 20);
    disk.platter().read_only = true;
    let mut recorder = on_faulty_disk(&disk, options("".as_ref()));
    assert_eq!(recorder.state(), State::Failed);
    assert!(recorder.status().reason.unwrap().starts_with("cannot create"));
    for ms in (0..10_000).step_by(100) {
        recorder.tick(at_ms(ms));
    }
    assert!(disk.names().unwrap().is_empty());
    disk.platter().read_only = false;
    recorder.tick(at_ms(11_000));
    assert_eq!(recorder.state(), State::Recording);
}

#[test]
fn the_free_space_floor_ends_a_file_properly() {
    let disk = FaultyDisk::new(2 << 20);
    let mut recorder =
        on_faulty_disk(&disk, JournalOptions { free_floor_bytes: u64::MAX, ..options("".as_ref()) });
    let image = channel("/image");
    let mut n = 0;
    while recorder.state() == State::Recording {
        recorder.store(vec![message(&image, n, 20_000)], at_ms(u64::from(n) * 400));
        recorder.tick(at_ms(u64::from(n) * 400 + 400));
        n += 1;
    }
    assert!(recorder.status().reason.unwrap().starts_with("disk full"));
    let finished = disk.names().unwrap();
    assert!(finished[0].ends_with("0001.mcap"), "{finished:?}");
    assert_eq!(sequences_on(&read_platter(&disk, &finished[0]), "/image"), (0..n).collect::<Vec<_>>());
    assert_eq!(recorder.ledger().total().lost(), 0);
}

#[test]
fn retention_deletes_the_oldest_of_this_vehicle_only() {
    let directory = tempfile::tempdir().unwrap();
    let foreign =
        ["other-20200101T000000Z-0001.mcap", "holiday.mcap", "car-20200101T000000Z-0000.mcap.active"];
    foreign.iter().for_each(|name| std::fs::write(directory.path().join(name), [0; 100_000]).unwrap());
    let retention = Some(Retention { max_total_bytes: 120_000 });
    let mut recorder = recorder(JournalOptions { retention, ..options(directory.path()) });
    let image = channel("/image");
    for n in 0..6 {
        recorder.store(vec![message(&image, n, 50_000)], at_ms(u64::from(n)));
        recorder.command(Command::Split, at_ms(u64::from(n)));
    }
    recorder.finish(at_ms(10));
    let left = names(directory.path());
    foreign.iter().for_each(|name| assert!(left.iter().any(|l| l == name), "{name} was deleted"));
    let ours: Vec<_> =
        left.iter().filter(|name| name.starts_with("car") && name.ends_with(".mcap")).collect();
    let numbers: Vec<_> = ours.iter().map(|name| FileName::parse(name).unwrap().number).collect();
    assert_eq!(numbers, [5, 6, 7], "two within the limit, and the last, empty one");
}

#[test]
fn the_clock_may_jump_without_a_name_colliding() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = recorder(options(directory.path()));
    let log = channel("/log");
    for (n, hour) in [0_i64, 1, -1, 0, 0, -2].into_iter().enumerate() {
        recorder.store(vec![message(&log, n as u32, 10)], at_ms(n as u64));
        let mut jumped = at_ms(n as u64);
        jumped.unix_ns = jumped.unix_ns.wrapping_add_signed(hour * 3_600_000_000_000);
        recorder.command(Command::Split, jumped);
    }
    recorder.finish(at_ms(10));
    let mut parsed: Vec<_> =
        names(directory.path()).iter().map(|name| FileName::parse(name).unwrap()).collect();
    parsed.sort();
    let sequences = parsed
        .iter()
        .map(|name| sequences_on(&read_strictly(&directory.path().join(name.finished())), "/log"));
    assert_eq!(
        sequences.flatten().collect::<Vec<_>>(),
        (0..6).collect::<Vec<_>>(),
        "series order is recording order"
    );
}

#[test]
fn a_restart_never_reuses_a_name() {
    let directory = tempfile::tempdir().unwrap();
    let log = channel("/log");
    for n in 0..3 {
        let mut recorder = recorder(options(directory.path()));
        recorder.store(vec![message(&log, n, 10)], at_ms(0));
        recorder.finish(at_ms(1));
    }
    assert_eq!(names(directory.path()).len(), 3);
}

#[test]
fn losses_are_told_in_the_next_file() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = recorder(options(directory.path()));
    let image = channel("/image");
    recorder.store(vec![message(&image, 0, 10)], at_ms(0));
    let mut refused = crate::Ledger::default();
    refused.topic("/image").lost_in_queue = 3;
    recorder.note_refused(&refused);
    recorder.finish(at_ms(1));
    let path = directory.path().join(names(directory.path()).pop().unwrap());
    let accounts = crate::info::Info::read(&path).unwrap().accounts.unwrap();
    let account = accounts.get("/image").copied().unwrap();
    assert_eq!((account.offered, account.stored, account.lost_in_queue), (4, 1, 3));
}

#[test]
fn metadata_records_are_written_into_each_file() {
    let directory = tempfile::tempdir().unwrap();
    let versions = BTreeMap::from([("waymark".to_owned(), "1.2.3".to_owned())]);
    let metadata = BTreeMap::from([("waymark.versions".to_owned(), versions.clone())]);
    let mut recorder = recorder(JournalOptions { metadata, ..options(directory.path()) });
    recorder.command(Command::Split, at_ms(1));
    recorder.finish(at_ms(2));
    for name in names(directory.path()) {
        let info = crate::info::Info::read(&directory.path().join(name)).unwrap();
        assert_eq!(info.metadata["waymark.versions"], versions);
    }
}

#[test]
fn a_vehicle_id_cannot_leave_the_directory() {
    for vehicle in ["../car", "", "Car", "car/1", "-car", "car\0"] {
        let options = JournalOptions { vehicle: vehicle.to_owned(), ..options("".as_ref()) };
        assert!(Recorder::new(options, FaultyDisk::new(0)).is_err(), "{vehicle:?}");
    }
}
