//! Windows, tolerances and shades tried on sequences, one after the other, each judged by what it finds and what it
//! claims falsely.

mod candidates;
mod judge;
pub mod plot;

use std::convert::Infallible;
use std::sync::Arc;

use vision::{Landmark, LandmarkSet, SetVersion};
use waymark_proto::digest::landmark_digest;

use crate::input::{Input, InputError};
use crate::register::{Event, Job, register};
use crate::score::Claim;
use candidates::candidates;
use judge::{Sightings, Tally};

pub use judge::Judge;

/// A false claim weighs as much as this many detections: a follower steers by what it is told.
const FALSE_CLAIM_WEIGHT: f64 = 5.0;

/// What a trial changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing: the landmark as it was given.
    Nothing,
    /// The window.
    Window,
    /// How far means may be off.
    MeanTolerance,
    /// How far variances may be off.
    VarianceTolerance,
    /// One shade less, or one that was seen and is far from the others.
    Shades,
}

impl Change {
    /// The order in which they are tried.
    const SWEEPS: [Self; 4] = [Self::Window, Self::MeanTolerance, Self::VarianceTolerance, Self::Shades];
}

/// An input and what tells right from wrong in it.
#[derive(Clone, Debug)]
pub struct Example {
    /// The frames.
    pub input: Input,
    /// What is right.
    pub judge: Judge,
}

/// One set of parameters and how it did.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What differs from the best trial before.
    pub change: Change,
    /// The parameters.
    pub landmark: Landmark,
    /// Part of the frames that show the object in which it was found.
    pub detection_rate: f64,
    /// Part of all judged frames with a claim that is wrong.
    pub false_rate: f64,
    /// The statistics of what was found rightly and is furthest from every shade.
    furthest: Option<vision::ColorStats>,
}

impl Trial {
    /// Larger is better.
    #[must_use]
    pub fn merit(&self) -> f64 {
        self.detection_rate - FALSE_CLAIM_WEIGHT * self.false_rate
    }
}

/// Tries windows, then tolerances of the means, then those of the variances, then shades, each with the best of what
/// was tried before. `on_trial` hears of each; the first is the landmark as given. Returns the best.
///
/// # Errors
/// When an input cannot be opened.
pub fn tune(
    examples: &[Example],
    landmark: &Landmark,
    job: &Job,
    mut on_trial: impl FnMut(&Trial),
) -> Result<Trial, InputError> {
    let mut best = trial(examples, landmark.clone(), Change::Nothing, job)?;
    on_trial(&best);
    for change in Change::SWEEPS {
        for candidate in candidates(&best.landmark, best.furthest, change) {
            let tried = trial(examples, candidate, change, job)?;
            on_trial(&tried);
            if tried.merit() > best.merit() {
                best = tried;
            }
        }
    }
    Ok(best)
}

/// How many trials [`tune`] makes at most.
#[must_use]
pub fn most_trials(landmark: &Landmark) -> usize {
    candidates::MOST_WITHOUT_SHADES + landmark.shades.len() + 2
}

fn trial(
    examples: &[Example],
    mut landmark: Landmark,
    change: Change,
    job: &Job,
) -> Result<Trial, InputError> {
    landmark.digest = landmark_digest(&landmark);
    let set = LandmarkSet { version: SetVersion::default(), landmarks: vec![Arc::new(landmark.clone())] };
    let job = Job { landmarks: Some(Arc::new(set)), ..job.clone() };
    let mut tally = Tally::default();
    for Example { input, judge } in examples {
        tally.add(judge, &sightings(input, &job)?, &landmark);
    }
    let (detection_rate, false_rate) = (tally.detection_rate(), tally.false_rate());
    Ok(Trial { change, landmark, detection_rate, false_rate, furthest: tally.furthest() })
}

fn sightings(input: &Input, job: &Job) -> Result<Sightings, InputError> {
    let mut sightings = Sightings::new();
    let frames = input.open()?;
    let Ok(_) = register(vec![(input.clone(), frames)], job, |_, event| -> Result<(), Infallible> {
        if let Event::Registered { frame, outcome, .. } = event {
            let seen = outcome
                .landmarks
                .iter()
                .filter_map(|landmark| Some((Claim::of(landmark)?, landmark.result.as_ref().ok()?.observed)));
            sightings.entry(frame).or_default().extend(seen);
        }
        Ok(())
    });
    Ok(sightings)
}
