//! What a run of `register` found and lost, for people.

use std::collections::BTreeMap;

use analysis::register::LostFrame;
use vision::Outcome;

use crate::console::Console;
use crate::exit::Ending;

/// Lost frames named one by one; a damaged card can hold thousands.
const NAMED_LOSSES: u64 = 20;

/// Counts over all inputs.
#[derive(Debug, Default)]
pub(super) struct Tally {
    registered: u64,
    lost: u64,
    /// Frames that each landmark was looked for in, and those that it was measured in.
    landmarks: BTreeMap<String, (u64, u64)>,
}

impl Tally {
    /// Counts a frame that was looked at.
    pub(super) fn count(&mut self, outcome: &Outcome) {
        self.registered += 1;
        let mut found: BTreeMap<&str, bool> = BTreeMap::new();
        for landmark in &outcome.landmarks {
            *found.entry(&landmark.landmark).or_default() |= landmark.result.is_ok();
        }
        for (landmark, measured) in found {
            let (looked_for, found) = self.landmarks.entry(landmark.to_owned()).or_default();
            *looked_for += 1;
            *found += u64::from(measured);
        }
    }

    /// Counts a frame that could not be looked at, and names it unless many were named already.
    pub(super) fn lose(&mut self, console: Console, lost: &LostFrame) {
        self.lost += 1;
        if self.lost <= NAMED_LOSSES {
            console.warn(&format!("lost: {lost}"));
        }
    }

    /// Says what came of it.
    pub(super) fn ending(&self, console: Console) -> Ending {
        for (landmark, &(frames, measured)) in &self.landmarks {
            let percent = 100.0 * measured as f64 / frames as f64;
            console.note(&format!("{landmark}: measured in {measured} of {frames} frames ({percent:.1} %)"));
        }
        if self.lost == 0 {
            return Ending::Fine;
        }
        let all = self.registered + self.lost;
        console.warn(&format!(
            "{} of {all} frames could not be read and are missing from the result",
            self.lost
        ));
        Ending::DataLost
    }
}
