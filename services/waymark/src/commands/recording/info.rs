//! `waymark recording info`.

use std::path::{Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};

use analysis::strip::strip;
use anyhow::{Context, anyhow};
use indicatif::{HumanBytes, HumanCount};
use ingest::recorded::LANDMARKS_ATTACHMENT;
use recording::info::{Info, TopicInfo};
use serde_json::{Value, json};
use vision::LandmarkSet;
use vision::frame::encode::{Quality, encode_jpeg, encode_png};
use waymark_proto::json::set_from_json;

use crate::columns::Columns;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Show what recordings hold: topics, rates, gaps, losses, landmarks
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Recordings, finished or cut
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Print one JSON object for each file
    #[arg(long)]
    json: bool,

    /// Write a strip of small pictures, results drawn in, a row for each camera (.jpg or .png); takes one recording
    #[arg(long, value_name = "STRIP")]
    images: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    if let Some(images) = &args.images {
        let [file] = &args.files[..] else {
            return Err(Failure::Usage(anyhow!(
                "--images writes the strip of one recording; give exactly one"
            )));
        };
        write_strip(file, images)?;
    }
    for (number, path) in args.files.iter().enumerate() {
        let info = Info::read(path).or_usage()?;
        let text = match (args.json, number) {
            (true, _) => format!("{}\n", as_json(&info)),
            (false, 0) => described(&info),
            (false, _) => format!("\n{}", described(&info)),
        };
        Console::write_results(text.as_bytes())?;
    }
    Ok(Ending::Fine)
}

fn write_strip(file: &Path, images: &Path) -> Result<(), Failure> {
    let frame = strip(file).or_usage()?;
    let frame = frame
        .ok_or_else(|| anyhow!("`{}` holds no pictures to make a strip of", file.display()))
        .or_usage()?;
    let is_png = images.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    let bytes = if is_png { encode_png(&frame) } else { encode_jpeg(&frame, Quality::default()) };
    let bytes = bytes.map_err(anyhow::Error::from)?;
    let written = std::fs::write(images, bytes);
    Ok(written.with_context(|| format!("cannot write `{}`", images.display()))?)
}

fn described(info: &Info) -> String {
    let mut text = format!("{}\n  {}\n", info.path.display(), head(info));
    text.push_str(&topics(info));
    for set in landmarks(info) {
        let names =
            set.landmarks.iter().map(|landmark| format!("{} ({})", landmark.id, landmark.shape.name()));
        let names: Vec<String> = names.collect();
        let version = format!("epoch {}, version {}", set.version.epoch, set.version.version);
        let listed = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        text.push_str(&format!("  landmarks, {version}: {listed}\n"));
    }
    for (compression, chunks) in &info.chunks {
        let name = if compression.is_empty() { "uncompressed" } else { compression };
        let (count, bytes) = (HumanCount(chunks.count), HumanBytes(chunks.compressed_bytes));
        text.push_str(&format!("  {count} {name} chunks, {bytes}\n"));
    }
    for fault in &info.faults {
        text.push_str(&format!("  damage {fault}\n"));
    }
    text
}

fn head(info: &Info) -> String {
    let size = format!("{}, {} messages", HumanBytes(info.bytes), HumanCount(info.messages()));
    let time = info.log_span_ns().map_or_else(String::new, |(first_ns, last_ns)| {
        format!(", {:.1} s from {}", (last_ns - first_ns) as f64 * 1e-9, utc(first_ns))
    });
    let writer = if info.library.is_empty() { "an unnamed library" } else { &info.library };
    format!("{size}{time}, written by {writer}")
}

fn utc(unix_ns: u64) -> String {
    humantime::format_rfc3339_millis(UNIX_EPOCH + Duration::from_nanos(unix_ns)).to_string()
}

fn topics(info: &Info) -> String {
    let mut table =
        Columns::new(["  topic", "schema", "messages", "Hz", "MiB", "longest gap s", "skipped", "lost"]);
    for (name, topic) in &info.topics {
        let gap_s = topic.longest_gap.map(|gap| gap.length_ns as f64 * 1e-9);
        let unknown = || "–".to_owned();
        table.row([
            format!("  {name}"),
            topic.schema.clone(),
            topic.messages.to_string(),
            topic.rate_hz().map_or_else(unknown, |rate_hz| format!("{rate_hz:.1}")),
            format!("{:.2}", topic.bytes as f64 / f64::from(1 << 20)),
            gap_s.map_or_else(unknown, |gap_s| format!("{gap_s:.3}")),
            topic.sequences_skipped.to_string(),
            lost(info, name).map_or_else(unknown, |lost| lost.to_string()),
        ]);
    }
    table.text()
}

/// Messages that the recorder itself counted as lost; unknown in a file that it did not finish.
fn lost(info: &Info, topic: &str) -> Option<u64> {
    info.accounts.as_ref().map(|accounts| accounts.get(topic).map_or(0, |account| account.lost()))
}

/// The landmark sets that the recording carries as attachments.
fn landmarks(info: &Info) -> impl Iterator<Item = LandmarkSet> {
    let sets = info.attachments.iter().filter(|attachment| attachment.name == LANDMARKS_ATTACHMENT);
    sets.filter_map(|attachment| set_from_json(&String::from_utf8_lossy(&attachment.data)).ok())
}

fn as_json(info: &Info) -> Value {
    let topics = info.topics.iter().map(|(name, topic)| topic_as_json(info, name, topic));
    let sets = landmarks(info).map(|set| {
        let ids: Vec<&str> = set.landmarks.iter().map(|landmark| landmark.id.as_str()).collect();
        json!({ "epoch": set.version.epoch, "version": set.version.version, "ids": ids })
    });
    json!({
        "path": info.path,
        "bytes": info.bytes,
        "library": info.library,
        "profile": info.profile,
        "messages": info.messages(),
        "first_log_time_ns": info.log_span_ns().map(|span| span.0),
        "last_log_time_ns": info.log_span_ns().map(|span| span.1),
        "topics": topics.collect::<Vec<_>>(),
        "landmarks": sets.collect::<Vec<_>>(),
        "metadata": info.metadata,
        "attachments": info.attachments.iter().map(|a| json!({ "name": a.name, "media_type": a.media_type, "bytes": a.data.len() })).collect::<Vec<_>>(),
        "faults": info.faults.iter().map(|fault| json!({ "offset": fault.offset, "what": fault.kind.to_string() })).collect::<Vec<_>>(),
    })
}

fn topic_as_json(info: &Info, name: &str, topic: &TopicInfo) -> Value {
    json!({
        "topic": name,
        "schema": topic.schema,
        "key_expression": topic.key_expression,
        "messages": topic.messages,
        "bytes": topic.bytes,
        "rate_hz": topic.rate_hz(),
        "longest_gap_s": topic.longest_gap.map(|gap| gap.length_ns as f64 * 1e-9),
        "sequences_skipped": topic.sequences_skipped,
        "lost": lost(info, name),
    })
}
