//! Recovery of files cut anywhere, damaged anywhere, and left behind by a crash.

use std::{collections::BTreeMap, ops::Range};

use super::*;
use crate::{
    ChunkFault, Compression, Disk, Recorder, Storage,
    file_name::FileName,
    scan::Scanner,
    testing::{at_ms, channel, latched, message, names, options, read_strictly, recorder, sequences_on},
    walk::Step,
};

/// A recording with a landmark, an image and a log topic, its chunks small.
fn record(directory: &Path, compression: Compression, frames: u32) -> Recorder<Disk> {
    let mut options = options(directory);
    options.writer.compression = compression;
    options.writer.chunk_bytes = 4_000;
    let mut recorder = recorder(options);
    let (image, log, landmark) = (channel("/image"), channel("/log"), channel("/landmark"));
    recorder.store(vec![latched(&landmark, 0, "red")], at_ms(0));
    for n in 0..frames {
        recorder.store(vec![message(&image, n, 1_000), message(&log, n, 30)], at_ms(u64::from(n)));
    }
    recorder
}

fn finished(directory: &Path, compression: Compression) -> PathBuf {
    record(directory, compression, 40).finish(at_ms(100));
    directory.join(names(directory).pop().unwrap())
}

/// Where each chunk record lies, with the log sequences within.
fn chunks(path: &Path) -> Vec<(Range<u64>, Vec<u32>)> {
    let mut scanner = Scanner::open(path).unwrap();
    let mut ends = BTreeMap::new();
    while let Some(record) = scanner.next_record().unwrap() {
        ends.insert(record.offset, record.end());
    }
    let mut chunks: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
    for step in Walk::open(path, CutChunk::Skip).unwrap() {
        match step.unwrap() {
            (offset, Step::Chunk(_)) => drop(chunks.insert(offset, Vec::new())),
            (offset, Step::Message(m)) if m.channel.topic == "/log" => {
                chunks.get_mut(&offset).unwrap().push(m.sequence);
            }
            _ => {}
        }
    }
    chunks.into_iter().map(|(offset, sequences)| (offset..ends[&offset], sequences)).collect()
}

#[test]
fn a_cut_at_every_997th_byte_keeps_every_whole_chunk_before_it() {
    for compression in [Compression::None, Compression::Lz4, Compression::Zstd] {
        let directory = tempfile::tempdir().unwrap();
        let whole = finished(directory.path(), compression);
        let (content, chunks) = (fs::read(&whole).unwrap(), chunks(&whole));
        assert!(chunks.len() > 8);
        for cut in (0..content.len()).step_by(997) {
            let (input, output) = (directory.path().join("cut"), directory.path().join("out.mcap"));
            fs::write(&input, &content[..cut]).unwrap();
            let report = recover(&input, &output, &WriterOptions::default()).unwrap();
            let kept = sequences_on(&read_strictly(&output), "/log");
            let whole = chunks.iter().take_while(|(range, _)| range.end <= cut as u64);
            let expected: Vec<u32> = whole.flat_map(|(_, sequences)| sequences.clone()).collect();
            assert_eq!(kept[..expected.len()], expected, "cut at {cut}");
            assert_eq!(
                kept,
                (0..kept.len() as u32).collect::<Vec<_>>(),
                "whole messages of the cut chunk follow"
            );
            assert_eq!(report.faults.len(), 1);
            assert_eq!(report.messages, read_strictly(&output).len() as u64);
            fs::remove_file(&output).unwrap();
        }
    }
}

#[test]
fn a_flipped_bit_costs_its_chunk_alone_and_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let whole = finished(directory.path(), Compression::None);
    let (content, chunks) = (fs::read(&whole).unwrap(), chunks(&whole));
    for (range, lost) in &chunks {
        let mut flipped = content.clone();
        flipped[range.end as usize - 20] ^= 0x10;
        let (input, output) = (directory.path().join("flipped"), directory.path().join("out.mcap"));
        fs::write(&input, &flipped).unwrap();
        let report = recover(&input, &output, &WriterOptions::default()).unwrap();
        let is_crc = |fault: &Fault| matches!(fault.kind, FaultKind::Chunk(ChunkFault::Crc { .. }));
        assert!(is_crc(&report.faults[0]) && report.faults[0].offset == range.start, "{:?}", report.faults);
        assert!(report.faults[0].to_string().contains("CRC failed"));
        let expected: Vec<u32> = (0..40).filter(|sequence| !lost.contains(sequence)).collect();
        let kept = sequences_on(&read_strictly(&output), "/log");
        assert_eq!(kept, expected, "only what was in the chunk at {range:?} is gone");
        assert!(report.lost_data());
        fs::remove_file(&output).unwrap();
    }
}

#[test]
fn no_flipped_byte_anywhere_makes_recovery_panic_or_invent() {
    let directory = tempfile::tempdir().unwrap();
    for compression in [Compression::None, Compression::Zstd] {
        let sub = directory.path().join(format!("{compression:?}"));
        let whole = finished(&sub, compression);
        let content = fs::read(&whole).unwrap();
        let known = read_strictly(&whole);
        for (index, at) in (0..content.len()).step_by(307).enumerate() {
            let mut flipped = content.clone();
            flipped[at] = flipped[at].wrapping_add([1, 0x80, 0xff][index % 3]);
            let (input, output) = (sub.join("flipped"), sub.join("out.mcap"));
            fs::write(&input, &flipped).unwrap();
            if let Ok(report) = recover(&input, &output, &WriterOptions::default()) {
                let read = read_strictly(&output);
                let invented = read.iter().filter(|m| !known.iter().any(|k| k.data == m.data)).count();
                assert!(invented == 0 || report.lost_data(), "byte {at}");
                fs::remove_file(&output).unwrap();
            }
        }
    }
}

#[test]
fn metadata_and_attachments_survive() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = record(directory.path(), Compression::None, 3);
    let data = bytes::Bytes::from_static(b"{}");
    let attachment = crate::Attachment {
        name: "set.json".into(),
        media_type: "application/json".into(),
        log_time_ns: 1,
        data,
    };
    recorder.attach(attachment.clone(), at_ms(5));
    recorder.finish(at_ms(9));
    let whole = directory.path().join(names(directory.path()).pop().unwrap());
    let output = directory.path().join("out.mcap");
    let report = recover(&whole, &output, &WriterOptions::default()).unwrap();
    assert!(report.faults.is_empty() && !report.lost_data());
    let (before, after) =
        (crate::info::Info::read(&whole).unwrap(), crate::info::Info::read(&output).unwrap());
    assert_eq!(
        (before.metadata, before.attachments, before.topics),
        (after.metadata, after.attachments, after.topics)
    );
}

#[test]
fn recovery_never_overwrites() {
    let directory = tempfile::tempdir().unwrap();
    let whole = finished(directory.path(), Compression::None);
    let taken = directory.path().join("taken.mcap");
    fs::write(&taken, b"precious").unwrap();
    assert!(recover(&whole, &taken, &WriterOptions::default()).is_err());
    assert_eq!(fs::read(&taken).unwrap(), b"precious");
}

#[test]
fn other_files_are_refused_by_name() {
    let directory = tempfile::tempdir().unwrap();
    let text = directory.path().join("notes.txt");
    fs::write(&text, b"not a recording").unwrap();
    let refused = recover(&text, &directory.path().join("out.mcap"), &WriterOptions::default());
    assert!(matches!(refused, Err(RecordingError::NotMcap(path)) if path == text));
}

#[test]
fn start_up_recovers_what_a_crash_left() {
    let directory = tempfile::tempdir().unwrap();
    let mut crashed = record(directory.path(), Compression::None, 20);
    crashed.tick(at_ms(10_000));
    let active = directory.path().join(names(directory.path()).pop().unwrap());
    let (content, name) = (fs::read(&active).unwrap(), FileName::new("car", 0, 7));
    crashed.finish(at_ms(10_001));
    // What kill -9 leaves: the bytes written so far, and no lock.
    fs::write(directory.path().join(name.active()), &content).unwrap();
    fs::write(directory.path().join("car-19700101T000000Z-0003.mcap.recovering"), b"half").unwrap();

    let leftovers = recover_directory(directory.path(), &WriterOptions::default()).unwrap();
    let [Leftover::Recovered(report)] = leftovers.as_slice() else { panic!("{leftovers:?}") };
    assert_eq!(report.cut_bytes, 0, "every byte was a whole chunk");
    let read = read_strictly(&directory.path().join(name.finished()));
    assert_eq!(sequences_on(&read, "/log"), (0..20).collect::<Vec<_>>());
    assert_eq!(names(directory.path()).len(), 2, "nothing else is left");
}

#[test]
fn a_crash_between_finish_and_rename_only_needs_the_rename() {
    let directory = tempfile::tempdir().unwrap();
    let whole = finished(directory.path(), Compression::None);
    let content = fs::read(&whole).unwrap();
    let active = whole.with_extension("mcap.active");
    fs::rename(&whole, &active).unwrap();
    let leftovers = recover_directory(directory.path(), &WriterOptions::default()).unwrap();
    assert!(matches!(leftovers.as_slice(), [Leftover::Renamed(path)] if *path == whole), "{leftovers:?}");
    assert_eq!(fs::read(&whole).unwrap(), content);
}

#[test]
fn a_live_writer_is_left_alone() {
    let directory = tempfile::tempdir().unwrap();
    let mut live = record(directory.path(), Compression::None, 5);
    assert!(recover_directory(directory.path(), &WriterOptions::default()).unwrap().is_empty());
    live.finish(at_ms(10));
    assert_eq!(Disk::new(directory.path()).finished("car").unwrap().len(), 1);
}

#[test]
fn a_damaged_original_is_kept() {
    let directory = tempfile::tempdir().unwrap();
    let whole = finished(directory.path(), Compression::None);
    let mut content = fs::read(&whole).unwrap();
    let middle = content.len() / 2;
    content[middle] ^= 1;
    fs::remove_file(&whole).unwrap();
    fs::write(whole.with_extension("mcap.active"), &content).unwrap();
    recover_directory(directory.path(), &WriterOptions::default()).unwrap();
    assert_eq!(fs::read(whole.with_extension("mcap.damaged")).unwrap(), content);
    read_strictly(&whole);
}
