//! `kill -9` at any moment: what the journal had counted as stored is in the recovered file, without a hole.
//!
//! The victim is this test binary itself, started again: it offers a message for every line it reads and answers
//! how many it has accepted and stored. `WAYMARK_KILLS` sets how often it is killed, `WAYMARK_KILLS_KEPT` a directory
//! that keeps what was recovered, for readers that are not ours (`tests/python/check_recording.py`). How many seconds each kill cost
//! is printed, not judged: it is a promise about a disk that keeps up, and this machine's may be busy.

#![allow(clippy::unwrap_used, reason = "a test ends where its preparation fails")]

use std::{
    io::{BufRead, BufReader, Lines, Write},
    path::Path,
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    sync::Arc,
    time::{Duration, Instant},
};

use bytes::Bytes;
use recording::{
    ChannelSpec, Journal, JournalOptions, Latch, Message, Offered, Schema, WriterOptions,
    check::{Verdict, check},
    reader::{MessageReader, Strictness},
    recover::{Leftover, recover_directory},
};

const DIRECTORY: &str = "WAYMARK_KILL_DIRECTORY";
const PICTURE_BYTES: usize = 8_000;

#[test]
fn kill_9_costs_nothing_that_was_stored() {
    let kills = std::env::var("WAYMARK_KILLS").map_or(4, |kills| kills.parse().unwrap());
    for kill in 0..kills {
        let directory = tempfile::tempdir().unwrap();
        let offers_after_first_stored = kill * 7_919 % 4_000;
        let Killed { accepted_at, stored } = run_and_kill(directory.path(), offers_after_first_stored);
        let killed_at = Instant::now();

        let leftovers = recover_directory(directory.path(), &WriterOptions::default()).unwrap();
        let [Leftover::Recovered(report)] = leftovers.as_slice() else { panic!("{leftovers:?}") };
        let recovered: Vec<u32> = MessageReader::open(&report.output, Strictness::Strict)
            .unwrap()
            .map(|message| message.unwrap().sequence)
            .collect();
        assert!(recovered.iter().copied().eq(0..recovered.len() as u32), "a hole before the end");
        assert!(recovered.len() as u64 >= stored, "{} of {stored} stored", recovered.len());
        assert_ne!(check(&report.output).unwrap().verdict(), Verdict::Damaged);
        if let Some(kept) = std::env::var_os("WAYMARK_KILLS_KEPT") {
            std::fs::copy(&report.output, Path::new(&kept).join(format!("kill-{kill:03}.mcap"))).unwrap();
        }
        let lost = accepted_at.get(recovered.len()).map_or(Duration::ZERO, |first| killed_at - *first);
        println!("kill {kill}: {} accepted, {} recovered, {lost:?} lost", accepted_at.len(), recovered.len());
    }
}

/// What the victim had said when it was killed.
struct Killed {
    /// When each message was accepted, in order.
    accepted_at: Vec<Instant>,
    /// How many of them were on the disk.
    stored: u64,
}

/// Kills the victim once it has been offered so many messages after the first were stored.
fn run_and_kill(directory: &Path, offers_after_first_stored: u32) -> Killed {
    let (mut victim, mut lines, mut answers) = start(directory);
    let mut killed = Killed { accepted_at: Vec::new(), stored: 0 };
    let mut offers_left = offers_after_first_stored;
    while killed.stored == 0 || offers_left > 0 {
        writeln!(lines, "offer").unwrap();
        // The test harness talks on the same pipe.
        let answer = answers.by_ref().map(Result::unwrap).find_map(|line| {
            let (accepted, stored) = line.strip_prefix("accepted ")?.split_once(" stored ")?;
            Some((accepted.parse::<usize>().unwrap(), stored.parse::<u64>().unwrap()))
        });
        let (accepted, stored) = answer.unwrap();
        killed.accepted_at.resize(accepted, Instant::now());
        if killed.stored > 0 {
            offers_left -= 1;
        }
        killed.stored = stored;
    }
    victim.kill().unwrap();
    victim.wait().unwrap();
    killed
}

fn start(directory: &Path) -> (Child, ChildStdin, Lines<BufReader<ChildStdout>>) {
    let mut victim = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "victim", "--ignored", "--nocapture"])
        .env(DIRECTORY, directory)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = victim.stdin.take().unwrap();
    let answers = BufReader::new(victim.stdout.take().unwrap()).lines();
    (victim, lines, answers)
}

#[test]
#[ignore = "the process that the other test kills"]
fn victim() {
    let Some(directory) = std::env::var_os(DIRECTORY) else { return };
    let journal =
        Journal::start(JournalOptions { free_floor_bytes: 0, ..JournalOptions::new(directory, "car") });
    let journal = journal.unwrap();
    let file_descriptor_set =
        Bytes::from_static(b"\x0a\x1c\x0a\x01t\x12\x04test\x22\x09\x0a\x07Message\x62\x06proto3");
    let channel = Arc::new(ChannelSpec {
        topic: "/car/status".to_owned(),
        key_expression: "car/status".to_owned(),
        schema: Schema { name: "test.Message".to_owned(), file_descriptor_set },
    });
    // Field 1, length-delimited.
    let mut data = vec![0x0a, (PICTURE_BYTES & 0x7f) as u8 | 0x80, (PICTURE_BYTES >> 7 & 0x7f) as u8 | 0x80];
    data.push((PICTURE_BYTES >> 14) as u8);
    data.resize(data.len() + PICTURE_BYTES, 0x55);
    let data = Bytes::from(data);
    let mut accepted = 0;
    for _ in std::io::stdin().lines() {
        let offered = journal.offer(Message {
            channel: Arc::clone(&channel),
            log_time_ns: u64::from(accepted) + 1,
            publish_time_ns: u64::from(accepted) + 1,
            sequence: accepted,
            data: data.clone(),
            latch: Latch::None,
        });
        accepted += u32::from(offered == Offered::Accepted);
        println!("accepted {accepted} stored {}", journal.ledger().total().stored);
    }
}
