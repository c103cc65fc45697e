//! What each stage costs: thread CPU time, so that other work on the machine does not show.

use rustix::time::{ClockId, clock_gettime};
use serde::Serialize;
use serde_json::{Map, Value, json};
use vision::{Stage, StageProbe};

/// CPU time of the calling thread since it began, in nanoseconds.
pub fn thread_cpu_ns() -> u64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

/// One sample per frame of everything that was timed.
#[derive(Clone, Debug, Default)]
pub struct StageTimes {
    decode_ns: Vec<u64>,
    register_ns: Vec<u64>,
    stages_ns: [Vec<u64>; Stage::ALL.len()],
}

/// Times the stages of one frame; a stage that runs several times, once for each landmark, is added up.
#[derive(Debug, Default)]
pub struct FrameClock {
    spent_ns: [u64; Stage::ALL.len()],
    begun_ns: u64,
}

impl StageProbe for FrameClock {
    fn begin(&mut self, _stage: Stage) {
        self.begun_ns = thread_cpu_ns();
    }

    fn end(&mut self, stage: Stage) {
        self.spent_ns[stage as usize] += thread_cpu_ns() - self.begun_ns;
    }
}

impl StageTimes {
    /// Adds one frame: what decoding cost, what all of `Follow::on_frame` cost, and the stages within.
    pub fn add(&mut self, decode_ns: u64, register_ns: u64, clock: &FrameClock) {
        self.decode_ns.push(decode_ns);
        self.register_ns.push(register_ns);
        for (samples, spent) in self.stages_ns.iter_mut().zip(clock.spent_ns) {
            samples.push(spent);
        }
    }

    /// Adds what another thread measured.
    pub fn merge(&mut self, other: Self) {
        self.decode_ns.extend(other.decode_ns);
        self.register_ns.extend(other.register_ns);
        for (samples, more) in self.stages_ns.iter_mut().zip(other.stages_ns) {
            samples.extend(more);
        }
    }

    /// The figures of `--stats`: `frames`, `cpu_s` and, for each stage, median, 99th percentile and mean.
    #[must_use]
    pub fn summary(&self) -> Value {
        let mut stages = Map::new();
        stages.insert("decode".to_owned(), json!(Spread::of(&self.decode_ns)));
        for (stage, samples) in Stage::ALL.iter().zip(&self.stages_ns) {
            stages.insert(stage.name().to_owned(), json!(Spread::of(samples)));
        }
        stages.insert("register".to_owned(), json!(Spread::of(&self.register_ns)));
        let cpu_ns: u64 = self.decode_ns.iter().chain(&self.register_ns).sum();
        json!({ "frames": self.decode_ns.len(), "cpu_s": cpu_ns as f64 * 1e-9, "stages": stages })
    }
}

/// Where a stage's costs lie; null when nothing was timed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Spread {
    p50_ms: Option<f64>,
    p99_ms: Option<f64>,
    mean_ms: Option<f64>,
}

impl Spread {
    fn of(samples_ns: &[u64]) -> Self {
        let mut sorted = samples_ns.to_vec();
        sorted.sort_unstable();
        let rank = |share: f64| {
            let nearest = (share * sorted.len() as f64).ceil() as usize;
            sorted.get(nearest.saturating_sub(1)).map(|&ns| ns as f64 * 1e-6)
        };
        let sum: u64 = sorted.iter().sum();
        let mean_ms = (!sorted.is_empty()).then(|| sum as f64 * 1e-6 / sorted.len() as f64);
        Self { p50_ms: rank(0.5), p99_ms: rank(0.99), mean_ms }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_nearest_rank() {
        let samples: Vec<u64> = (1..=100).rev().map(|ms| ms * 1_000_000).collect();
        let spread = Spread::of(&samples);
        assert_eq!((spread.p50_ms, spread.p99_ms, spread.mean_ms), (Some(50.0), Some(99.0), Some(50.5)));
        assert_eq!(Spread::of(&[]).p50_ms, None);
    }

    #[test]
    fn a_stage_is_added_up_within_a_frame() {
        let mut clock = FrameClock::default();
        for _ in 0..2 {
            clock.begin(Stage::Mask);
            std::hint::black_box((0..100_000u64).fold(0, |sum, i| sum ^ std::hint::black_box(i)));
            clock.end(Stage::Mask);
        }
        let mut times = StageTimes::default();
        times.add(1_000_000, 3_000_000, &clock);
        times.merge(times.clone());
        let summary = times.summary();
        assert_eq!(summary["frames"], 2);
        assert!((summary["cpu_s"].as_f64().unwrap() - 0.008).abs() < 1e-9);
        assert_eq!(summary["stages"]["decode"]["p50_ms"], 1.0);
        assert!(summary["stages"]["mask"]["mean_ms"].as_f64().unwrap() > 0.0);
        assert_eq!(summary["stages"]["hough"]["p99_ms"], 0.0);
    }
}
