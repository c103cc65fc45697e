//! The demo: router, simulator, leader and follower as real sessions in one process.

use std::path::{Path, PathBuf};
use std::process::Command;

use recording::info::Info;
use serde_json::Value;
use tests::face::Face;
use tests::program::Program;
use tests::{DEADLINE, free_address, workspace};

/// A demo with every file and address of its own.
pub(crate) struct Demo {
    pub(crate) program: Program,
    pub(crate) face: Face,
    pub(crate) recordings: tempfile::TempDir,
}

impl Demo {
    /// Starts it and waits until its camera is live and landmarks are looked for.
    pub(crate) fn start(duration: &str) -> Self {
        let recordings = tempfile::tempdir().unwrap();
        let (follower, leader) = (free_address(), free_address());
        let directory = recordings.path().to_str().unwrap();
        let program = Program::start([
            "demo",
            "--headless",
            "--json",
            "--duration",
            duration,
            "--seed",
            "7",
            "--listen",
            &follower,
            "--leader-listen",
            &leader,
            "--recordings",
            directory,
        ]);
        let _announced = program.note(&format!("http://{follower}"));
        let face = Face::at(&format!("http://{follower}")).once_reachable();
        face.json_once("/api/v1/status", is_registering);
        Self { program, face, recordings }
    }

    /// Files in its directory of recordings with this ending.
    pub(crate) fn files(&self, ending: &str) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.recordings.path()).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        paths.filter(|path| path.to_str().is_some_and(|path| path.ends_with(ending))).collect()
    }
}

fn is_registering(status: &Value) -> bool {
    let cameras = status["cameras"].as_array().cloned().unwrap_or_default();
    cameras.iter().any(|camera| camera["landmarks"].as_array().is_some_and(|landmarks| !landmarks.is_empty()))
}

#[test]
fn a_demo_registers_answers_and_records() {
    let demo = Demo::start("8s");
    assert_eq!(demo.face.get("/livez").status, 200);
    let page = demo.face.get("/");
    assert_eq!((page.status, page.media_type.as_str()), (200, "text/html"));
    let camera = demo.face.json("/api/v1/status")["cameras"][0]["id"].as_str().unwrap().to_owned();
    let overlay = demo.face.get(&format!("/api/v1/cameras/{camera}/overlay.jpg"));
    assert_eq!((overlay.status, &overlay.body[..2]), (200, [0xFF, 0xD8].as_slice()));

    let Demo { program, recordings, .. } = demo;
    let ended = program.ended_within(DEADLINE);
    assert_eq!(ended.code, Some(0), "{}", ended.transcript());
    let result: Value = serde_json::from_str(&ended.stdout).unwrap();
    for landmark in ["red", "blue"] {
        let score = score_of(&result, landmark);
        assert!(score["detection_rate"].as_f64().unwrap() > 0.9, "{result:#}");
        assert!(score["false_rate"].as_f64().unwrap() < 0.02, "{result:#}");
        assert!(score["centre_median_px"].as_f64().unwrap() < 3.0, "{result:#}");
    }
    let file = PathBuf::from(result["recording"].as_str().unwrap());
    assert!(file.starts_with(recordings.path()) && file.is_file(), "{result:#}");
    assert_complete(&file);
}

#[test]
fn sigterm_finishes_the_recording_while_clients_are_attached() {
    let demo = Demo::start("600s");
    demo.face.json_once("/api/v1/status", |status| status["cameras"][0]["sequence"].as_u64() > Some(60));
    let _events = demo.face.stream("/api/v1/events");
    let camera = demo.face.json("/api/v1/status")["cameras"][0]["id"].as_str().unwrap().to_owned();
    let _pictures = demo.face.stream(&format!("/api/v1/cameras/{camera}/stream.mjpeg"));
    demo.program.terminate();
    let Demo { program, recordings, .. } = demo;
    let ended = program.ended_within(DEADLINE);
    assert_eq!(ended.code, Some(0), "{}", ended.transcript());
    let files: Vec<_> =
        std::fs::read_dir(recordings.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(files.len(), 1, "{files:?}");
    assert_complete(&files[0]);
}

fn score_of<'a>(result: &'a Value, landmark: &str) -> &'a Value {
    let scores = result["landmarks"].as_array().unwrap();
    scores
        .iter()
        .find(|score| score["id"] == landmark)
        .unwrap_or_else(|| panic!("no {landmark} in {result:#}"))
}

/// Finished, undamaged, and on every topic as many messages as were offered and not counted as lost.
fn assert_complete(file: &Path) {
    let info = Info::read(file).unwrap();
    assert!(info.faults.is_empty(), "{:?}", info.faults);
    let accounts = info.accounts.as_ref().unwrap();
    for (topic, account) in accounts.iter() {
        let found = info.topics.get(topic).map_or(0, |topic| topic.messages);
        assert_eq!(found, account.offered - account.lost() + account.repeated, "{topic}: {account:?}");
    }
    assert!(
        info.topics.values().any(|topic| topic.schema == "waymark.v1.Registration" && topic.messages >= 10)
    );
    assert_opens_elsewhere(file);
}

/// Reads the recording with Python's MCAP libraries, when `WAYMARK_PYTHON` names an interpreter that has them.
pub(crate) fn assert_opens_elsewhere(file: &Path) {
    let Some(python) = std::env::var_os("WAYMARK_PYTHON") else {
        eprintln!("SKIPPED: WAYMARK_PYTHON is not set, the recording was not read in Python (see tests/run)");
        return;
    };
    let script = workspace().join("tests/python/check_recording.py");
    let output = Command::new(python).arg(script).arg(file).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    // 3: the file is right, and says that messages were lost; how many is asserted elsewhere.
    assert!(matches!(output.status.code(), Some(0 | 3)), "{said}");
}
