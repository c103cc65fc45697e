//! The time of one stage.

use vision::{Stage, StageProbe};

use super::clock::thread_cpu_us;

/// Hears of every stage and times one.
pub(crate) struct StageTime {
    stage: Stage,
    began_us: f64,
    spent_us: f64,
}

impl StageTime {
    pub(crate) fn of(stage: Stage) -> Self {
        Self { stage, began_us: 0.0, spent_us: 0.0 }
    }

    pub(crate) fn spent_us(&self) -> f64 {
        self.spent_us
    }
}

impl StageProbe for StageTime {
    fn begin(&mut self, stage: Stage) {
        if stage == self.stage {
            self.began_us = thread_cpu_us();
        }
    }

    fn end(&mut self, stage: Stage) {
        if stage == self.stage {
            self.spent_us += thread_cpu_us() - self.began_us;
        }
    }
}
