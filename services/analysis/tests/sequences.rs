//! Rendered and real sequences, registered from start to end and scored by the rule of `analysis::score`.
//!
//! The sequences are not part of the project; where they are missing, these tests say so and pass.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::io::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use analysis::follow_choice::FollowChoice;
use analysis::input::Input;
use analysis::learn::learn_from_files;
use analysis::register::{Event, Job, Timing, register};
use analysis::score::{Claim, Score, score};
use analysis::truth::Truth;
use vision::follow::Mode;
use vision::learn::LearnOptions;
use vision::{LandmarkSet, SetVersion, ShapeClass};

/// The directory of shared sequences, if this machine has it.
fn sequences() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let shared = std::env::var_os("WAYMARK_SHARED").map_or(beside, PathBuf::from);
    let sequences = shared.join("data/sequences");
    if sequences.is_dir() {
        return Some(sequences);
    }
    // Past the test harness, which swallows what a passing test prints.
    let place = sequences.display();
    let told = format!("SKIPPED: no sequences in {place}; set WAYMARK_SHARED to what holds data/sequences\n");
    std::io::stderr().write_all(told.as_bytes()).unwrap();
    None
}

struct Case {
    frames: PathBuf,
    truth: PathBuf,
    regions: Vec<String>,
    object: &'static str,
    shape: ShapeClass,
}

impl Case {
    fn score(&self, mode: Mode) -> Score {
        let regions: Vec<_> = self.regions.iter().map(|region| region.parse().unwrap()).collect();
        let options =
            LearnOptions { id: self.object.to_owned(), shape: self.shape, ..LearnOptions::default() };
        let landmark = learn_from_files(&regions, &options).unwrap();
        let set = LandmarkSet { version: SetVersion::default(), landmarks: vec![Arc::new(landmark)] };
        let job = Job {
            landmarks: Some(Arc::new(set)),
            choice: FollowChoice { mode: Some(mode), ..FollowChoice::default() },
            threads: NonZeroUsize::MIN,
            timing: Timing::Off,
            overlays: None,
        };
        score(&Truth::read(&self.truth, self.object).unwrap(), &claims(&self.frames, &job))
    }
}

fn claims(frames: &Path, job: &Job) -> BTreeMap<u64, Vec<Claim>> {
    let input = Input::parse(frames.to_str().unwrap()).unwrap();
    let frames = input.open().unwrap();
    let mut claims: BTreeMap<u64, Vec<Claim>> = BTreeMap::new();
    let done = register(vec![(input, frames)], job, |_, event| -> Result<(), Infallible> {
        let Event::Registered { frame, outcome, .. } = event else { panic!("{event:?}") };
        claims.entry(frame).or_default().extend(outcome.landmarks.iter().filter_map(Claim::of));
        Ok(())
    });
    done.unwrap();
    claims
}

fn rink(sequences: &Path) -> Case {
    let frames = sequences.join("rink");
    Case {
        truth: frames.join("truth.csv"),
        regions: vec![format!("{}#xywh=446,314,26,24", frames.join("f037.jpg").display())],
        object: "red",
        shape: ShapeClass::Block,
        frames,
    }
}

#[test]
fn the_red_block_of_the_rink() {
    let Some(sequences) = sequences() else { return };
    let faithful = rink(&sequences).score(Mode::Faithful);
    assert!(faithful.detection_rate >= Some(0.63) && faithful.false_rate <= Some(0.01), "{faithful:?}");
    let adaptive = rink(&sequences).score(Mode::Adaptive);
    assert!(adaptive.detection_rate >= Some(0.99) && adaptive.false_rate <= Some(0.005), "{adaptive:?}");
}

#[test]
fn the_orange_shirt() {
    let Some(sequences) = sequences() else { return };
    let frames = sequences.join("orange_shirt/frames");
    let case = Case {
        truth: sequences.join("orange_shirt/gt.txt"),
        regions: vec![format!("{}#xywh=261,48,39,65", frames.join("0001.jpg").display())],
        object: "shirt",
        shape: ShapeClass::Any,
        frames,
    };
    for mode in [Mode::Faithful, Mode::Adaptive] {
        let score = case.score(mode);
        assert!(score.detection_rate >= Some(0.95) && score.false_rate <= Some(0.01), "{mode:?}: {score:?}");
    }
}
