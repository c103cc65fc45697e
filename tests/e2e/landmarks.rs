//! The landmark set of a follower, whatever happens in which order: services as processes of their own.

use leader::Edit;
use serde_json::Value;
use tests::DEADLINE;
use tests::face::Face;
use tests::program::Program;

use crate::convoy::{Place, connect, landmark, publish};

/// Ids and red means of the landmarks that a follower looks for.
fn looked_for(document: &Value) -> Vec<(String, f64)> {
    let landmarks = document["landmarks"].as_array().cloned().unwrap_or_default();
    let red_mean = |landmark: &Value| landmark["shades"][0]["mean"][0].as_f64().unwrap();
    landmarks
        .iter()
        .map(|landmark| (landmark["id"].as_str().unwrap().to_owned(), red_mean(landmark)))
        .collect()
}

fn await_landmarks(face: &Face, wanted: &[(&str, f64)]) {
    face.json_once("/api/v1/landmarks", |document| {
        let found = looked_for(document);
        found.iter().map(|(id, mean)| (id.as_str(), *mean)).eq(wanted.iter().copied())
    });
}

/// Both processes run on this machine, so their clocks differ by no more than the measurement may be wrong.
fn await_clocks(face: &Face) {
    let has_clock = |member: &Value| member["clock"]["in_step"] == true && member["answers"] == true;
    face.json_once("/api/v1/fleet", |fleet| {
        let members = fleet["members"].as_array().cloned().unwrap_or_default();
        let names: Vec<_> = members.iter().map(|one| format!("{}/{}", one["vehicle"], one["role"])).collect();
        members.iter().all(has_clock) && names == [r#""follower"/"follower""#, r#""leader"/"leader""#]
    });
    let status = face.json_once("/api/v1/status", |status| status["leader"]["clock"].is_object());
    let clock = &status["leader"]["clock"];
    let (offset_ms, uncertainty_ms) = (&clock["offset_ms"], &clock["uncertainty_ms"]);
    assert!(offset_ms.as_f64().unwrap().abs() <= uncertainty_ms.as_f64().unwrap() + 0.001, "{clock}");
    let metrics = String::from_utf8(face.get("/metrics").body).unwrap();
    assert!(
        metrics.contains("waymark_clock_offset_seconds{vehicle=\"leader\",role=\"leader\"}"),
        "{metrics}"
    );
}

#[test]
fn landmarks_of_before_during_and_while_away_all_end_up_right() {
    let place = Place::new();
    let _router = place.start_router();
    let (_leader, _) = place.start_service("leader", "leader", &[]);
    let camera = ["camera", "--set", &connect(&place.endpoint), "--set", "source=sim:rink?seed=5&fps=10"];
    let _camera = Program::start(camera);
    place.edit(&publish([landmark("blue", 20.0), landmark("red", 120.0)]));

    let (follower, face) = place.start_follower("follower", &[]);
    await_landmarks(&face, &[("blue", 20.0), ("red", 120.0)]);
    await_clocks(&face);

    place.edit(&publish([landmark("red", 140.0)]));
    await_landmarks(&face, &[("blue", 20.0), ("red", 140.0)]);

    follower.terminate();
    let ended = follower.ended_within(DEADLINE);
    assert_eq!(ended.code, Some(0), "{}", ended.transcript());
    place.edit(&Edit { retire: vec!["blue".to_owned()], ..publish([]) });

    let (_follower, face) = place.start_follower("follower", &[]);
    await_landmarks(&face, &[("red", 140.0)]);
}
