//! CPU seconds per megabyte of the journal against the bare `mcap` writer, and what compression gains.
//!
//! `cargo run --release -p recording --example throughput -- DIRECTORY [SECONDS] [ROUNDS] [PICTURES…]` writes the
//! load of eight cameras (30 pictures a second each; 200 kB of noise without PICTURES) to DIRECTORY, in real time. The
//! writers take turns, ROUNDS times each; of each the cheapest round counts, which others disturbed least. The bare
//! writer is measured as it comes, and made to keep as much through a power cut as the journal does.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a measuring program talks and may stop")]
#![allow(clippy::disallowed_methods, reason = "cameras have a pace")]

use std::{
    collections::BTreeMap,
    fs::File,
    io::BufWriter,
    path::Path,
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use bytes::Bytes;
use mcap::records::MessageHeader;
use recording::{ChannelSpec, Compression, Journal, JournalOptions, Latch, Message, Schema};
use rustix::time::{ClockId, clock_gettime};

const CAMERAS: usize = 8;
const RATE_HZ: u32 = 30;
/// The journal syncs every 400 ms.
const FRAMES_A_SYNC: u32 = 12;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let directory = arguments.next().expect("give a directory to write to");
    let seconds: u32 = arguments.next().map_or(10, |seconds| seconds.parse().unwrap());
    let rounds: usize = arguments.next().map_or(3, |rounds| rounds.parse().unwrap());
    let pictures = load(arguments);
    let frames = seconds * RATE_HZ;
    let megabytes = f64::from(frames) * CAMERAS as f64 * mean_bytes(&pictures) / 1e6;
    println!("{frames} frames of {CAMERAS} cameras, {megabytes:.0} MB in {seconds} s, {rounds} rounds");

    for compression in [Compression::None, Compression::Lz4, Compression::Zstd] {
        let (mut bare_ms, mut safe_ms, mut ours_ms, mut lost) =
            (f64::INFINITY, f64::INFINITY, f64::INFINITY, 0);
        let (mut bare_bytes, mut ours_bytes) = (0, 0);
        for _ in 0..rounds {
            let (spent_s, bytes) = bare(Path::new(&directory), compression, Syncs::Never, frames, &pictures);
            (bare_ms, bare_bytes) = (bare_ms.min(spent_s * 1e3 / megabytes), bytes);
            let (spent_s, _) =
                bare(Path::new(&directory), compression, Syncs::AsTheJournal, frames, &pictures);
            safe_ms = safe_ms.min(spent_s * 1e3 / megabytes);
            let (spent_s, bytes, lost_now) = journal(Path::new(&directory), compression, frames, &pictures);
            (ours_ms, ours_bytes, lost) = (ours_ms.min(spent_s * 1e3 / megabytes), bytes, lost + lost_now);
        }
        println!(
            "{compression:?}: bare {bare_ms:.3} ms/MB ({safe_ms:.3} synced as the journal), {bare_bytes} bytes; journal \
             {ours_ms:.3} ms/MB, {ours_bytes} bytes, {lost} lost; ratio {:.2} ({:.2})",
            ours_ms / bare_ms,
            ours_ms / safe_ms
        );
    }
}

fn load(paths: impl Iterator<Item = String>) -> Vec<Bytes> {
    let pictures: Vec<Bytes> = paths.map(|path| std::fs::read(path).unwrap().into()).collect();
    if !pictures.is_empty() {
        return pictures;
    }
    let mut random = 1_u64;
    let mut noise = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 56) as u8
    };
    // More than a chunk holds, so that no compressor finds a picture twice.
    (0..32).map(|_| (0..200_000).map(|_| noise()).collect()).collect()
}

fn mean_bytes(pictures: &[Bytes]) -> f64 {
    pictures.iter().map(|picture| picture.len() as f64).sum::<f64>() / pictures.len() as f64
}

fn picture(pictures: &[Bytes], camera: usize, frame: u32) -> &Bytes {
    &pictures[(frame as usize * CAMERAS + camera) % pictures.len()]
}

/// Calls `write` with every camera and frame number, at the rate of the cameras.
fn in_real_time(frames: u32, mut write: impl FnMut(usize, u32)) {
    let begun = Instant::now();
    for frame in 0..frames {
        let due = Duration::from_secs(1) / RATE_HZ * frame;
        thread::sleep(due.saturating_sub(begun.elapsed()));
        (0..CAMERAS).for_each(|camera| write(camera, frame));
    }
}

/// Whether the bare writer sees to it that the disk has what was written.
#[derive(Clone, Copy, PartialEq)]
enum Syncs {
    Never,
    AsTheJournal,
}

fn bare(
    directory: &Path,
    compression: Compression,
    syncs: Syncs,
    frames: u32,
    pictures: &[Bytes],
) -> (f64, u64) {
    let path = directory.join("bare.mcap");
    let began_s = cpu_s();
    let compression = match compression {
        Compression::None => None,
        Compression::Lz4 => Some(mcap::Compression::Lz4),
        Compression::Zstd => Some(mcap::Compression::Zstd),
    };
    let options = mcap::WriteOptions::new().compression(compression).compression_threads(0);
    let file = File::create(&path).unwrap();
    let mut writer = options.create(BufWriter::new(file.try_clone().unwrap())).unwrap();
    let channels: Vec<u16> = (0..CAMERAS)
        .map(|camera| writer.add_channel(0, &format!("/{camera}"), "", &BTreeMap::new()).unwrap())
        .collect();
    in_real_time(frames, |camera, frame| {
        let log_time = u64::from(frame);
        let header =
            MessageHeader { channel_id: channels[camera], sequence: frame, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, picture(pictures, camera, frame)).unwrap();
        if syncs == Syncs::AsTheJournal && camera == 0 && frame % FRAMES_A_SYNC == 0 {
            writer.flush().unwrap();
            file.sync_data().unwrap();
        }
    });
    writer.finish().unwrap();
    drop(writer);
    let spent_s = cpu_s() - began_s;
    let bytes = std::fs::metadata(&path).unwrap().len();
    std::fs::remove_file(path).unwrap();
    (spent_s, bytes)
}

fn journal(directory: &Path, compression: Compression, frames: u32, pictures: &[Bytes]) -> (f64, u64, u64) {
    let began_s = cpu_s();
    let mut options = JournalOptions::new(directory, "bench");
    options.writer.compression = compression;
    options.rotation.max_bytes = u64::MAX;
    let journal = Journal::start(options).unwrap();
    let channels: Vec<_> = (0..CAMERAS).map(channel).collect();
    in_real_time(frames, |camera, frame| {
        let log_time_ns = u64::from(frame);
        let _counted = journal.offer(Message {
            channel: Arc::clone(&channels[camera]),
            log_time_ns,
            publish_time_ns: log_time_ns,
            sequence: frame,
            data: picture(pictures, camera, frame).clone(),
            latch: Latch::None,
        });
    });
    let report = journal.finish(Duration::from_secs(60));
    let spent_s = cpu_s() - began_s;
    let path = report.status.file.unwrap();
    let bytes = std::fs::metadata(&path).unwrap().len();
    std::fs::remove_file(path).unwrap();
    (spent_s, bytes, report.ledger.total().lost())
}

fn channel(camera: usize) -> Arc<ChannelSpec> {
    let topic = format!("/{camera}");
    let schema = Schema { name: "bench.Picture".to_owned(), file_descriptor_set: Bytes::new() };
    Arc::new(ChannelSpec { key_expression: topic.clone(), topic, schema })
}

/// CPU time of the whole process, seconds.
fn cpu_s() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
