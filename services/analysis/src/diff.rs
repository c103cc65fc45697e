//! Two results of the same frame compared: what changed, where, by how much.

mod fields;
mod tally;

use serde::Serialize;
use vision::{LandmarkOutcome, Outcome};

use crate::input::Past;
use crate::row::FrameKey;

pub use tally::{DiffTally, FieldTally};

/// One field of one landmark's result that is not what it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The landmark's id; empty where the whole frame differs.
    pub landmark: String,
    /// Which of several objects that match it.
    pub instance: u32,
    /// What changed.
    pub field: &'static str,
    /// What the recording says; empty where it says nothing.
    pub recorded: String,
    /// What is found now; empty where nothing is.
    pub again: String,
    /// By how much, in the field's unit; `None` where that is no number.
    pub difference: Option<f64>,
}

/// A [`Change`] as a row of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DiffRow<'a> {
    /// The input as it was given.
    pub input: &'a str,
    /// Counts from 1 within its input and camera.
    pub frame: Option<u64>,
    /// Capture time, ns since the Unix epoch.
    pub captured_at_ns: i64,
    /// The camera's id.
    pub camera: Option<&'a str>,
    /// See [`Change::landmark`].
    pub landmark: &'a str,
    /// See [`Change::instance`].
    pub instance: u32,
    /// See [`Change::field`].
    pub field: &'static str,
    /// See [`Change::recorded`].
    pub recorded: &'a str,
    /// See [`Change::again`].
    pub again: &'a str,
    /// See [`Change::difference`].
    pub difference: Option<f64>,
    /// `whole`, or `missing` where a picture that the recorded result rests on is not in the file.
    pub past: &'static str,
}

impl DiffRow<'_> {
    /// The columns' names in their order.
    pub const COLUMNS: [&'static str; 11] = [
        "input",
        "frame",
        "captured_at_ns",
        "camera",
        "landmark",
        "instance",
        "field",
        "recorded",
        "again",
        "difference",
        "past",
    ];
}

/// A change as the row of its frame.
#[must_use]
pub fn diff_row<'a>(key: FrameKey<'a>, captured_at_ns: i64, past: Past, change: &'a Change) -> DiffRow<'a> {
    DiffRow {
        input: key.input,
        frame: key.frame,
        captured_at_ns,
        camera: key.camera,
        landmark: &change.landmark,
        instance: change.instance,
        field: change.field,
        recorded: &change.recorded,
        again: &change.again,
        difference: change.difference,
        past: past.name(),
    }
}

/// Everything in which `again` is not `recorded`; empty exactly when they are equal in every field.
#[must_use]
pub fn changes(recorded: &Outcome, again: &Outcome) -> Vec<Change> {
    let mut changes = fields::of_frame(recorded, again);
    for old in &recorded.landmarks {
        match find(again, old) {
            Some(new) => changes.extend(fields::of_landmark(old, new)),
            None => changes.push(fields::only(old, "measured or missed", "")),
        }
    }
    let new = again.landmarks.iter().filter(|landmark| find(recorded, landmark).is_none());
    changes.extend(new.map(|landmark| fields::only(landmark, "", "measured or missed")));
    if changes.is_empty() && recorded != again {
        changes.push(fields::whole_frame("order", String::new(), String::new()));
    }
    changes
}

fn find<'a>(outcome: &'a Outcome, like: &LandmarkOutcome) -> Option<&'a LandmarkOutcome> {
    outcome
        .landmarks
        .iter()
        .find(|landmark| landmark.landmark == like.landmark && landmark.instance == like.instance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vision::{Digest, Miss, PointPx, Sighting};

    fn outcome(results: Vec<Result<Sighting, Miss>>) -> Outcome {
        let landmarks = (0..).zip(results).map(|(instance, result)| LandmarkOutcome {
            landmark: "red".to_owned(),
            digest: Digest::default(),
            instance,
            prediction: None,
            gate: None,
            result,
            innovation_px: None,
            adaptation: None,
        });
        Outcome { landmarks: landmarks.collect(), ..Outcome::default() }
    }

    fn seen(x: f32) -> Sighting {
        let outline = vec![PointPx::new(x - 2.0, 1.0), PointPx::new(x + 2.0, 1.0)];
        Sighting { centroid: PointPx::new(x, 3.0), area_px2: 20.0, outline, ..Sighting::default() }
    }

    fn told(changes: &[Change]) -> Vec<(&str, Option<f64>)> {
        changes.iter().map(|change| (change.field, change.difference)).collect()
    }

    #[test]
    fn equal_results_have_no_changes() {
        let outcome = outcome(vec![Ok(seen(4.0)), Err(Miss::TooSmall)]);
        assert_eq!(changes(&outcome, &outcome), []);
    }

    #[test]
    fn a_moved_object_is_told_by_its_distance() {
        let changes = changes(&outcome(vec![Ok(seen(4.0))]), &outcome(vec![Ok(seen(4.5))]));
        assert_eq!(told(&changes), [("centroid_px", Some(0.5)), ("outline_px", Some(0.5))]);
        assert_eq!((changes[0].recorded.as_str(), changes[0].again.as_str()), ("4 3", "4.5 3"));
    }

    #[test]
    fn a_lost_and_a_new_instance_are_told() {
        let (one, two) = (outcome(vec![Ok(seen(4.0))]), outcome(vec![Err(Miss::TooSmall), Ok(seen(4.0))]));
        let found = changes(&one, &two);
        assert_eq!(found[0].field, "result");
        assert_eq!((found[0].recorded.as_str(), found[0].again.as_str()), ("measured", "too_small"));
        assert_eq!((found[1].field, found[1].instance, found[1].recorded.as_str()), ("instance", 1, ""));
        assert_eq!(changes(&two, &one)[1].again, "");
    }

    #[test]
    fn reasons_of_misses_are_compared_to_their_figures() {
        let (one, two) = (Miss::WrongShape { score: 0.25 }, Miss::WrongShape { score: 0.5 });
        let changes = changes(&outcome(vec![Err(one)]), &outcome(vec![Err(two)]));
        assert_eq!(told(&changes), [("miss", None)]);
    }

    #[test]
    fn what_no_field_tells_is_told_all_the_same() {
        let one = outcome(vec![Ok(seen(4.0)), Err(Miss::TooSmall)]);
        let mut two = one.clone();
        two.landmarks.reverse();
        assert_eq!(told(&changes(&one, &two)), [("order", None)]);
    }
}
