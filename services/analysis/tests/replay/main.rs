//! A recording registered again says what it said live, frame by frame and field by field.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use analysis::again::{AgainError, AgainWriter};
use analysis::diff::{DiffTally, changes};
use analysis::follow_choice::FollowChoice;
use analysis::input::{Input, Past};
use analysis::recorded::RecordedOutcomes;
use analysis::register::{Event, Job, Timing, register};
use recording::check::{Verdict, check};
use recording::reader::{MessageReader, Strictness};
use vision::follow::Mode;
use vision::{LandmarkSet, Outcome};

use crate::drive::{
    CAMERA, Change, Coding, FIRST_SEQUENCE, drive, drive_changing, drive_sending, landmark, set,
};

mod drive;

fn replayed(input: &str, landmarks: Option<Arc<LandmarkSet>>) -> (Vec<u64>, Vec<Outcome>) {
    replayed_as(input, landmarks, FollowChoice::default())
}

fn replayed_as(
    input: &str,
    landmarks: Option<Arc<LandmarkSet>>,
    choice: FollowChoice,
) -> (Vec<u64>, Vec<Outcome>) {
    let frames = frames_of(input, landmarks, choice).into_iter();
    frames
        .map(|frame| {
            assert_ne!(frame.recorded, Some(Past::Missing));
            (frame.number, frame.outcome)
        })
        .unzip()
}

struct Replayed {
    number: u64,
    outcome: Outcome,
    recorded: Option<Past>,
}

fn frames_of(input: &str, landmarks: Option<Arc<LandmarkSet>>, choice: FollowChoice) -> Vec<Replayed> {
    let input = Input::parse(input).unwrap();
    let frames = input.open().unwrap();
    let job = Job { landmarks, choice, threads: NonZeroUsize::MIN, timing: Timing::Off, overlays: None };
    let mut replayed = Vec::new();
    let done = register(vec![(input, frames)], &job, |_, event| -> Result<(), Infallible> {
        let Event::Registered { frame, camera, outcome, recorded, .. } = event else { panic!("{event:?}") };
        assert_eq!(camera.as_deref(), Some(CAMERA));
        replayed.push(Replayed { number: frame, outcome, recorded });
        Ok(())
    });
    done.unwrap();
    replayed
}

/// Compares a file with itself registered again.
fn compared(file: &Path, choice: FollowChoice) -> DiffTally {
    let mut recorded = RecordedOutcomes::open(file, None).unwrap();
    let mut tally = DiffTally::default();
    for frame in frames_of(file.to_str().unwrap(), None, choice) {
        let (captured_at, sequence) = (frame.outcome.captured_at, frame.outcome.sequence);
        let live = recorded.take(CAMERA, captured_at, sequence).unwrap().unwrap();
        tally.count(frame.recorded.unwrap(), &changes(&live, &frame.outcome));
    }
    tally
}

#[test]
fn a_comparison_finds_nothing_where_nothing_changed_and_something_where_it_did() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let same = compared(&files[1], FollowChoice::default());
    assert_eq!((same.compared, same.different, same.fields.len()), (5, 0, 0), "{same:?}");
    let faithful = FollowChoice { mode: Some(Mode::Faithful), ..FollowChoice::default() };
    let changed = compared(&files[1], faithful);
    assert_eq!(changed.different, changed.compared);
    assert!(changed.fields["gain"].changes > 0, "{changed:?}");
}

#[test]
fn frames_behind_a_lost_picture_are_told_apart_until_the_next_state() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive_sending(directory.path(), Coding::Jpeg, Some(12));
    let tallies: Vec<DiffTally> = files.iter().map(|file| compared(file, FollowChoice::default())).collect();
    assert_eq!(tallies.iter().map(|tally| tally.different).collect::<Vec<_>>(), [0, 0, 0]);
    assert_eq!((tallies[0].without_past, tallies[2].without_past), (0, 0));
    assert!(tallies[1].without_past > 0 && tallies[1].compared > 0, "{:?}", tallies[1]);
}

#[test]
fn a_recording_written_again_has_the_old_and_the_new() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let output = directory.path().join("again.mcap");
    let mut again = AgainWriter::begin(&files[1], &output, None).unwrap();
    let camera = Arc::from(CAMERA);
    let frames = frames_of(files[1].to_str().unwrap(), None, FollowChoice::default());
    for frame in &frames {
        again.add(frame.number, &camera, &frame.outcome, &[]).unwrap();
    }
    again.finish(BTreeMap::new(), None).unwrap();
    let read = |path: &Path| -> Vec<_> {
        MessageReader::open(path, Strictness::Strict).unwrap().map(Result::unwrap).collect()
    };
    let (new, old): (Vec<_>, Vec<_>) =
        read(&output).into_iter().partition(|message| message.channel.topic.ends_with("/again"));
    assert_eq!(old, read(&files[1]));
    assert_eq!(new.len(), 2 * frames.len());
    assert_eq!(check(&output).unwrap().verdict(), Verdict::Fine);
    let registered: Vec<Outcome> = frames.into_iter().map(|frame| frame.outcome).collect();
    assert_eq!(replayed(output.to_str().unwrap(), None).1, registered);
    let twice = AgainWriter::begin(&output, &directory.path().join("twice.mcap"), None).unwrap();
    assert!(matches!(twice.finish(BTreeMap::new(), None), Err(AgainError::Twice { .. })));
}

#[test]
fn each_file_of_a_series_alone_replays_what_was_live_in_every_field() {
    let directory = tempfile::tempdir().unwrap();
    let (files, live) = drive(directory.path());
    assert_eq!(files.len(), 3);
    assert!(live.iter().all(|outcome| outcome.landmarks.iter().any(|landmark| landmark.result.is_ok())));
    let outcomes = assert_each_alone_replays(&files, live);
    let versions: BTreeSet<u64> = outcomes.iter().map(|outcome| outcome.set_version.version).collect();
    assert_eq!(versions, BTreeSet::from([1, 2]));
}

/// That the files, each by itself, say of their pictures what was said live; returns what they say.
fn assert_each_alone_replays(files: &[PathBuf], live: Vec<Outcome>) -> Vec<Outcome> {
    let replays = files.iter().map(|file| replayed(file.to_str().unwrap(), None));
    let outcomes: Vec<Outcome> = replays.flat_map(|(_, outcomes)| outcomes).collect();
    // A result that came after its picture's file had ended belongs to no file.
    let apart = [6, 8, 16, 17].map(|number| FIRST_SEQUENCE + number);
    let expected: Vec<Outcome> =
        live.into_iter().filter(|outcome| !apart.contains(&outcome.sequence)).collect();
    let sequences = |outcomes: &[Outcome]| outcomes.iter().map(|o| o.sequence).collect::<Vec<_>>();
    assert_eq!(sequences(&outcomes), sequences(&expected));
    for (replayed, live) in outcomes.iter().zip(&expected) {
        assert_eq!(replayed, live);
    }
    outcomes
}

#[test]
fn a_set_that_changes_where_a_file_ends_is_replayed_on_both_sides() {
    let other = || set(2, vec![landmark("dark", 60.0), landmark("red", 195.0)]);
    let retired = || set(3, vec![landmark("dark", 60.0)]);
    // The second file begins with picture 9, the third with picture 18.
    for (behind, looked_for_from) in [(8, 9), (8, 10), (7, 8), (8, 14), (9, 10)] {
        let directory = tempfile::tempdir().unwrap();
        let changes = [
            Change { behind, looked_for_from, set: other() },
            Change { behind: behind + 9, looked_for_from: looked_for_from + 9, set: retired() },
        ];
        let (files, live) = drive_changing(directory.path(), Coding::Jpeg, None, &changes);
        assert_each_alone_replays(&files, live);
    }
}

#[test]
fn two_sets_under_one_version_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    // A changed landmark arrives before the manifest that counts the change.
    let changed = |version| set(version, vec![landmark("red", 195.0)]);
    let changes = [
        Change { behind: 3, looked_for_from: 4, set: changed(1) },
        Change { behind: 5, looked_for_from: 6, set: changed(2) },
    ];
    let (files, live) = drive_changing(directory.path(), Coding::Jpeg, None, &changes);
    assert_each_alone_replays(&files, live);
}

#[test]
fn each_file_of_recorded_video_begins_with_a_keyframe_and_replays_alone() {
    let directory = tempfile::tempdir().unwrap();
    let (files, live) = drive_sending(directory.path(), Coding::video(), None);
    let replays: Vec<_> = files.iter().map(|file| replayed(file.to_str().unwrap(), None)).collect();
    // Asked for after pictures 8 and 17, begun with the keyframes 12 and 18.
    assert_eq!(replays.iter().map(|(numbers, _)| numbers[0]).collect::<Vec<_>>(), [1, 1, 1]);
    assert_eq!(replays[1].1[0].sequence, FIRST_SEQUENCE + 12);
    assert_eq!(replays[2].1[0].sequence, FIRST_SEQUENCE + 18);
    let outcomes: Vec<Outcome> = replays.into_iter().flat_map(|(_, outcomes)| outcomes).collect();
    let at = |outcome: &Outcome| live.iter().find(|live| live.sequence == outcome.sequence).cloned();
    for outcome in &outcomes {
        assert_eq!(at(outcome).as_ref(), Some(outcome), "picture {}", outcome.sequence - FIRST_SEQUENCE);
    }
    // Four results were late when their pictures' file ended.
    assert_eq!(outcomes.len(), live.len() - 4);
}

#[test]
fn another_way_of_following_has_a_past_of_its_own() {
    let directory = tempfile::tempdir().unwrap();
    let (files, live) = drive(directory.path());
    let choice = FollowChoice { mode: Some(Mode::Faithful), ..FollowChoice::default() };
    let (_, outcomes) = replayed_as(files[1].to_str().unwrap(), None, choice);
    let first = outcomes[0].clone();
    let landmark = &first.landmarks[0];
    assert!(landmark.prediction.is_none() && landmark.adaptation.is_none(), "{landmark:?}");
    assert!(!live.contains(&first));
}

#[test]
fn other_landmarks_are_looked_for_in_every_frame() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let given = Arc::new(set(0, vec![landmark("other", 200.0)]));
    let input = format!("mcap:{}#/v2/camera/front/image", files[0].display());
    let (numbers, outcomes) = replayed(&input, Some(given));
    assert_eq!(numbers, (1..=9).collect::<Vec<_>>());
    assert!(outcomes.iter().all(|outcome| outcome.landmarks[0].landmark == "other"));
}

#[test]
fn a_topic_that_is_not_there_is_answered_with_those_that_are() {
    let directory = tempfile::tempdir().unwrap();
    let (files, _) = drive(directory.path());
    let input = Input::parse(&format!("mcap:{}#/v2/camera/rear/image", files[0].display())).unwrap();
    let Err(error) = input.open() else { panic!("opened") };
    let error = error.to_string();
    assert!(error.ends_with("its image topics are /v2/camera/front/image"), "{error}");
}
