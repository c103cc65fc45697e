//! `kill -9` at random moments: what was offered a second before is in the recovered file.
//!
//! The victim is this test binary itself, started again: it offers a message for every line it reads and
//! answers what became of it. `WAYMARK_KILLS` sets how often it is killed.

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
    ChannelSpec, Journal, JournalOptions, Latch, Message, Schema, WriterOptions,
    check::{Verdict, check},
    reader::{MessageReader, Strictness},
    recover::{Leftover, recover_directory},
};

const DIRECTORY: &str = "WAYMARK_KILL_DIRECTORY";
const PICTURE_BYTES: usize = 8_000;

#[test]
fn kill_9_costs_less_than_a_second() {
    let kills = std::env::var("WAYMARK_KILLS").map_or(4, |kills| kills.parse().unwrap());
    for kill in 0..kills {
        let directory = tempfile::tempdir().unwrap();
        let lifetime = Duration::from_millis(300 + kill * 769 % 2_000);
        let accepted = run_and_kill(directory.path(), lifetime);
        let killed_at = Instant::now();

        let leftovers = recover_directory(directory.path(), &WriterOptions::default()).unwrap();
        let [Leftover::Recovered(report)] = leftovers.as_slice() else { panic!("{leftovers:?}") };
        let recovered: Vec<u32> = MessageReader::open(&report.output, Strictness::Strict)
            .unwrap()
            .map(|message| message.unwrap().sequence)
            .collect();
        let all: Vec<u32> = accepted.iter().map(|(sequence, _)| *sequence).collect();
        assert!(all.starts_with(&recovered) || recovered.starts_with(&all), "a hole before the end");
        let safe = accepted.iter().filter(|(_, at)| killed_at - *at > Duration::from_secs(1)).count();
        assert!(recovered.len() >= safe, "{} of {safe} after {lifetime:?}", recovered.len());
        assert_ne!(check(&report.output).unwrap().verdict(), Verdict::Damaged);
    }
}

/// Runs the victim for `lifetime`; returns which messages it accepted, and when.
fn run_and_kill(directory: &Path, lifetime: Duration) -> Vec<(u32, Instant)> {
    let (mut victim, mut lines, mut answers) = start(directory);
    let begun = Instant::now();
    let mut accepted = Vec::new();
    for sequence in 0.. {
        writeln!(lines, "offer").unwrap();
        // The test harness talks on the same pipe.
        let mut answer =
            answers.by_ref().map(Result::unwrap).filter(|line| line == "Accepted" || line == "Refused");
        if answer.next().unwrap() == "Accepted" {
            accepted.push((sequence, Instant::now()));
        }
        if begun.elapsed() > lifetime {
            break;
        }
    }
    victim.kill().unwrap();
    victim.wait().unwrap();
    accepted
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
        topic: "/image".to_owned(),
        key_expression: "image".to_owned(),
        schema: Schema { name: "test.Message".to_owned(), file_descriptor_set },
    });
    // Field 1, length-delimited.
    let mut data = vec![0x0a, (PICTURE_BYTES & 0x7f) as u8 | 0x80, (PICTURE_BYTES >> 7 & 0x7f) as u8 | 0x80];
    data.push((PICTURE_BYTES >> 14) as u8);
    data.resize(data.len() + PICTURE_BYTES, 0x55);
    let data = Bytes::from(data);
    for (sequence, _) in std::io::stdin().lines().enumerate() {
        let (sequence, time_ns) = (sequence as u32, sequence as u64 + 1);
        let offered = journal.offer(Message {
            channel: Arc::clone(&channel),
            log_time_ns: time_ns,
            publish_time_ns: time_ns,
            sequence,
            data: data.clone(),
            latch: Latch::None,
        });
        println!("{offered:?}");
    }
}
