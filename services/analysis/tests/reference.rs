//! The reference recordings: what is recorded has the expected figures, and registering again is as good.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use analysis::drive::Drive;
use analysis::figures::Figures;
use analysis::follow_choice::FollowChoice;
use analysis::input::Input;
use analysis::register::{Event, Job, Timing, register};
use analysis::report::report;
use analysis::score::{Claim, Score, score};
use analysis::truth::{Truth, meant_object};
use recording::check::{Verdict, check};
use vision::Outcome;
use vision::follow::Mode;

const LARGEST_BYTES: u64 = 5 << 20;

fn reference(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../recordings/reference").join(name)
}

fn recordings() -> [(PathBuf, Figures); 2] {
    ["rink", "stop-sign"].map(|name| {
        let expected = std::fs::read_to_string(reference(&format!("{name}.expected.json"))).unwrap();
        (reference(&format!("{name}.mcap")), serde_json::from_str(&expected).unwrap())
    })
}

fn registered_again(file: &Path) -> Vec<Outcome> {
    registered(&[file], FollowChoice::default(), NonZeroUsize::MIN)
}

/// Every outcome of the files, in their order.
fn registered(files: &[&Path], choice: FollowChoice, threads: NonZeroUsize) -> Vec<Outcome> {
    let input = |file: &&Path| {
        let input = Input::parse(file.to_str().unwrap()).unwrap();
        let frames = input.open().unwrap();
        (input, frames)
    };
    let job = Job { landmarks: None, choice, threads, timing: Timing::Off, overlays: None };
    let mut outcomes = Vec::new();
    let done = register(files.iter().map(input).collect(), &job, |_, event| -> Result<(), Infallible> {
        let Event::Registered { outcome, .. } = event else { panic!("{event:?}") };
        outcomes.push(outcome);
        Ok(())
    });
    done.unwrap();
    outcomes
}

fn scored(drive: &Drive, outcomes: &[Outcome], landmark: &str) -> Score {
    let camera = &drive.cameras["front"];
    let (mut truth, mut claims) = (Truth::default(), BTreeMap::new());
    for (number, outcome) in (1..).zip(outcomes) {
        let frame = &camera.frames[&(outcome.captured_at, outcome.sequence as u32)];
        let claimed: Vec<Claim> =
            outcome.landmarks.iter().filter(|l| l.landmark == landmark).filter_map(Claim::of).collect();
        truth.frames.insert(number, meant_object(frame.truth.as_ref().unwrap(), landmark, &claimed));
        claims.insert(number, claimed);
    }
    score(&truth, &claims)
}

#[test]
fn what_is_recorded_has_the_expected_figures() {
    for (file, expected) in recordings() {
        assert!(std::fs::metadata(&file).unwrap().len() <= LARGEST_BYTES, "{}", file.display());
        assert_eq!(check(&file).unwrap().verdict(), Verdict::Fine, "{}", file.display());
        let found = Figures::of(&file, &Drive::read(&file).unwrap()).unwrap();
        let found = Figures { recording: expected.recording.clone(), ..found };
        // Both through text, as reading a number may round its last bit.
        let found: Figures = serde_json::from_str(&serde_json::to_string(&found).unwrap()).unwrap();
        assert_eq!(serde_json::to_value(found).unwrap(), serde_json::to_value(expected).unwrap());
    }
}

/// Not bit for bit: the method may become better than when these were recorded, but not worse.
#[test]
fn registered_again_they_score_no_worse() {
    for (file, expected) in recordings() {
        let drive = Drive::read(&file).unwrap();
        let outcomes = registered_again(&file);
        assert_eq!(outcomes.len() as u64, expected.cameras[0].registered);
        for landmark in &expected.cameras[0].landmarks {
            let (new, old) = (scored(&drive, &outcomes, &landmark.id), landmark.score.as_ref().unwrap());
            let what = format!("{} in {}: {new:?}, recorded {old:?}", landmark.id, file.display());
            assert!(new.detection_rate.unwrap() >= old.detection_rate.unwrap() - 0.02, "{what}");
            assert!(new.false_rate.unwrap() <= old.false_rate.unwrap() + 0.02, "{what}");
            assert!(new.centre_median_px.unwrap() <= old.centre_median_px.unwrap() + 0.2, "{what}");
        }
    }
}

#[test]
fn several_threads_say_what_one_says_in_every_bit() {
    let [rink, stop_sign] = recordings().map(|(file, _)| file);
    let files = [rink.as_path(), stop_sign.as_path(), rink.as_path()];
    for mode in [Mode::Faithful, Mode::Adaptive] {
        let choice = FollowChoice { mode: Some(mode), ..FollowChoice::default() };
        let [one, four] =
            [1, 4].map(|threads| registered(&files, choice, NonZeroUsize::new(threads).unwrap()));
        assert!(one.iter().flat_map(|outcome| &outcome.landmarks).any(|landmark| landmark.result.is_ok()));
        assert!(one == four, "{}", mode.name());
    }
}

#[test]
fn a_report_needs_nothing_beside_itself() {
    for (file, expected) in recordings() {
        let html = report(&file).unwrap().html;
        for there in
            ["Tables 4.4 and 4.5", "Appendix B", "Detection over time", "Worst frames", "<svg", "Losses"]
        {
            assert!(html.contains(there), "no {there}");
        }
        assert!(html.contains("src=\"data:image/jpeg;base64,"));
        assert!(
            !html.contains("http://")
                || html.matches("http://").count() == html.matches("http://www.w3.org/").count()
        );
        assert!(!html.contains("https://") && !html.contains("<script"));
        for landmark in &expected.cameras[0].landmarks {
            assert!(html.contains(&format!("Landmark {}", landmark.id)));
        }
    }
}
