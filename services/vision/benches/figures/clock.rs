//! The smallest CPU time of many runs, for many subjects in turn.

use rustix::time::{ClockId, clock_gettime};

/// How often every subject has its turn.
const ROUNDS: usize = 7;
/// A turn ends after so much time, but not before it ran so often.
const TURN_US: f64 = 4_000.0;
const LEAST_RUNS: usize = 2;

/// Runs a subject once and tells the microseconds that count.
type Run<'a> = Box<dyn FnMut() -> f64 + 'a>;

/// Subjects with the smallest time of each.
#[derive(Default)]
pub(crate) struct Rounds<'a> {
    subjects: Vec<(String, Run<'a>)>,
}

impl<'a> Rounds<'a> {
    /// One more subject; `line` names it.
    pub(crate) fn add(&mut self, line: String, mut run: impl FnMut() + 'a) {
        self.add_timed(line, move || {
            let start_us = thread_cpu_us();
            run();
            thread_cpu_us() - start_us
        });
    }

    /// One more subject, which times itself.
    pub(crate) fn add_timed(&mut self, line: String, run: impl FnMut() -> f64 + 'a) {
        self.subjects.push((line, Box::new(run)));
    }

    /// Every subject's line with its smallest time in microseconds.
    pub(crate) fn measure(mut self) -> Vec<(String, f64)> {
        let mut smallest_us = vec![f64::INFINITY; self.subjects.len()];
        for _ in 0..ROUNDS {
            for ((_, run), smallest_us) in self.subjects.iter_mut().zip(&mut smallest_us) {
                *smallest_us = smallest_us.min(turn(run));
            }
        }
        self.subjects.into_iter().map(|(line, _)| line).zip(smallest_us).collect()
    }
}

/// One subject's turn: the smallest time of its runs.
fn turn(run: &mut Run<'_>) -> f64 {
    let (mut smallest_us, mut runs) = (f64::INFINITY, 0);
    let start_us = thread_cpu_us();
    while thread_cpu_us() - start_us < TURN_US || runs < LEAST_RUNS {
        smallest_us = f64::min(smallest_us, run());
        runs += 1;
    }
    smallest_us
}

/// The CPU time of this thread.
pub(crate) fn thread_cpu_us() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 / 1e3
}
