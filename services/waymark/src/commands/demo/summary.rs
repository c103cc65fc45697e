//! How the drive went, for people and for programs.

use std::io::Write;

use analysis::score::Score;
use follower::status::Dropped;
use serde::Serialize;

use super::convoy::Driven;
use crate::console::Console;

/// The one object of `--json` (contract section 9).
#[derive(Serialize)]
struct Summary {
    duration_s: f64,
    frames: u64,
    recording: Option<String>,
    http: String,
    landmarks: Vec<LandmarkSummary>,
    latency_ms: Latency,
    dropped: Dropped,
    /// Messages the recorder could not keep.
    recorder_lost: u64,
}

#[derive(Serialize)]
struct LandmarkSummary {
    id: String,
    #[serde(flatten)]
    score: Score,
}

#[derive(Serialize)]
struct Latency {
    p50: Option<f64>,
    p99: Option<f64>,
}

/// Writes the summary to stdout.
pub(super) fn write(driven: &Driven, json: bool) -> anyhow::Result<()> {
    let summary = Summary::of(driven);
    let mut out = Console::results();
    if json {
        serde_json::to_writer(&mut out, &summary)?;
        writeln!(out)?;
    } else {
        table(&summary, &mut out)?;
    }
    out.flush()?;
    Ok(())
}

impl Summary {
    fn of(driven: &Driven) -> Self {
        let status = &driven.follower.status;
        let landmarks = driven.scorer.landmarks();
        let recorder = &driven.follower.recorder;
        Self {
            duration_s: driven.duration.as_secs_f64(),
            frames: driven.scorer.frames(),
            recording: recorder.status.file.as_ref().map(|file| file.display().to_string()),
            http: driven.page.clone(),
            landmarks: landmarks.into_iter().map(|(id, score)| LandmarkSummary { id, score }).collect(),
            latency_ms: Latency { p50: driven.scorer.latency_ms(0.5), p99: driven.scorer.latency_ms(0.99) },
            dropped: status.cameras.first().map_or_else(Dropped::default, |camera| camera.dropped),
            recorder_lost: recorder.ledger.total().lost(),
        }
    }
}

fn table(summary: &Summary, out: &mut impl Write) -> std::io::Result<()> {
    let percent = |rate: Option<f64>| rate.map_or("—".to_owned(), |rate| format!("{:.1} %", 100.0 * rate));
    let pixels = |error: Option<f64>| error.map_or("—".to_owned(), |error| format!("{error:.2} px"));
    let milliseconds = |time: Option<f64>| time.map_or("—".to_owned(), |time| format!("{time:.1} ms"));
    writeln!(
        out,
        "\n{:<12} {:>9} {:>9} {:>13} {:>11}",
        "landmark", "detected", "false", "centre median", "centre p95"
    )?;
    for landmark in &summary.landmarks {
        let score = &landmark.score;
        writeln!(
            out,
            "{:<12} {:>9} {:>9} {:>13} {:>11}",
            landmark.id,
            percent(score.detection_rate),
            percent(score.false_rate),
            pixels(score.centre_median_px),
            pixels(score.centre_p95_px)
        )?;
    }
    let dropped: u64 = summary.dropped.by_reason().iter().map(|(_, count)| count).sum();
    writeln!(
        out,
        "\n{} frames in {:.1} s, {dropped} dropped; capture to result {} (median), {} (99 %)",
        summary.frames,
        summary.duration_s,
        milliseconds(summary.latency_ms.p50),
        milliseconds(summary.latency_ms.p99)
    )?;
    match &summary.recording {
        Some(file) => writeln!(out, "recording: {file} ({} messages lost)", summary.recorder_lost),
        None => writeln!(out, "nothing was recorded"),
    }
}
