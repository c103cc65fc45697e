//! The landmark set of a follower, whatever happens in which order: services as processes of their own.

use std::path::Path;

use leader::client::LandmarkClient;
use leader::{Edit, Others};
use runtime::SessionSettings;
use serde_json::Value;
use tests::face::Face;
use tests::program::Program;
use tests::{DEADLINE, free_address};
use tokio::runtime::Runtime;
use vision::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};
use waymark_proto::keys::VehicleKeys;

/// A router, a leader and a camera; followers come and go.
struct Convoy {
    endpoint: String,
    directory: tempfile::TempDir,
    _services: [Program; 3],
}

impl Convoy {
    fn start() -> Self {
        let directory = tempfile::tempdir().unwrap();
        let endpoint = format!("tcp/{}", free_address());
        let router = Program::start(["router", "--listen", &endpoint]);
        let _listens = router.note(&endpoint);
        let leader = start_service("leader", &endpoint, directory.path(), &free_address(), &[]);
        let camera = ["camera", "--set", &connect(&endpoint), "--set", "source=sim:rink?seed=5&fps=10"];
        Self { endpoint, directory, _services: [router, leader, Program::start(camera)] }
    }

    fn start_follower(&self) -> (Program, Face) {
        let address = free_address();
        let recordings = format!("recorder.directory={}", self.directory.path().join("recordings").display());
        let program =
            start_service("follower", &self.endpoint, self.directory.path(), &address, &[&recordings]);
        (program, Face::at(&format!("http://{address}")))
    }

    /// Has the leader change its set, as `waymark landmark publish` and `retire` do.
    fn edit(&self, edit: &Edit) {
        let edited = Runtime::new().unwrap().block_on(async {
            let session = SessionSettings::client(&self.endpoint).open().await.unwrap();
            let keys = VehicleKeys::new("convoy", "leader").unwrap();
            LandmarkClient::new(session, keys).edit(edit).await
        });
        edited.unwrap();
    }
}

/// Starts a leader or a follower and waits until its web face answers.
fn start_service(role: &str, endpoint: &str, directory: &Path, address: &str, more: &[&str]) -> Program {
    let state = format!("state_dir={}", directory.join(role).display());
    let (connect, listen) = (connect(endpoint), format!("http.listen={address}"));
    let settings = [connect.as_str(), &state, &listen].into_iter().chain(more.iter().copied());
    let program = Program::start([role].into_iter().chain(settings.flat_map(|setting| ["--set", setting])));
    let _page = program.note(address);
    program
}

fn connect(endpoint: &str) -> String {
    format!("zenoh.connect=[\"{endpoint}\"]")
}

fn landmark(id: &str, red_mean: f32) -> Landmark {
    Landmark {
        id: id.to_owned(),
        revision: 0,
        window_px: WindowPx { width: 8, height: 8 },
        shades: vec![ColorStats { mean: [red_mean, 40.0, 40.0], variance: [30.0; 3] }],
        tolerance: ColorStats { mean: [15.0; 3], variance: [50.0; 3] },
        shape: ShapeClass::Any,
        size_m: None,
        digest: Digest::default(),
    }
}

fn publish(landmarks: impl Into<Vec<Landmark>>) -> Edit {
    Edit { publish: landmarks.into(), retire: Vec::new(), others: Others::Keep }
}

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

#[test]
fn landmarks_of_before_during_and_while_away_all_end_up_right() {
    let convoy = Convoy::start();
    convoy.edit(&publish([landmark("blue", 20.0), landmark("red", 120.0)]));

    let (follower, face) = convoy.start_follower();
    await_landmarks(&face, &[("blue", 20.0), ("red", 120.0)]);

    convoy.edit(&publish([landmark("red", 140.0)]));
    await_landmarks(&face, &[("blue", 20.0), ("red", 140.0)]);

    follower.terminate();
    let ended = follower.ended_within(DEADLINE);
    assert_eq!(ended.code, Some(0), "{}", ended.transcript());
    convoy.edit(&Edit { retire: vec!["blue".to_owned()], ..publish([]) });

    let (_follower, face) = convoy.start_follower();
    await_landmarks(&face, &[("red", 140.0)]);
}
