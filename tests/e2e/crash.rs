//! What a power cut costs.

use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use recording::info::Info;
use tests::{DEADLINE, waymark};

use crate::demo::{Demo, assert_opens_elsewhere};

/// Frames that are registered before the program is killed: some seconds of drive.
const FRAMES_BEFORE: u64 = 120;

/// What may be missing, s: many times what is promised for a disk that keeps up, as this one may be busy.
const MISSING_AT_MOST_S: f64 = 10.0;

#[test]
fn kill_nine_costs_the_last_moments_of_a_recording() {
    let demo = Demo::start("600s");
    demo.face.json_once("/api/v1/status", |status| {
        status["cameras"][0]["sequence"].as_u64() > Some(FRAMES_BEFORE)
    });
    let killed_at_ns = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos();
    demo.program.kill();
    let cut = demo.files(".mcap.active").pop().unwrap();
    let Demo { program, recordings, .. } = demo;
    assert_eq!(program.ended_within(DEADLINE).code, None);

    let recovered = recordings.path().join("recovered.mcap");
    let output = Command::new(waymark())
        .args(["recording", "recover"])
        .arg(&cut)
        .arg("-o")
        .arg(&recovered)
        .output()
        .unwrap();
    assert!(matches!(output.status.code(), Some(0 | 3)), "{output:?}");

    let info = Info::read(&recovered).unwrap();
    assert!(info.faults.is_empty(), "{:?}", info.faults);
    let registrations = info.topics.values().find(|topic| topic.schema == "waymark.v1.Registration").unwrap();
    let (_, last_ns) = registrations.log_span_ns.unwrap();
    let missing_s = killed_at_ns.saturating_sub(u128::from(last_ns)) as f64 / 1e9;
    let kept = format!("{missing_s:.3} s are missing; {} registrations were kept", registrations.messages);
    eprintln!("{kept}");
    assert!(missing_s < MISSING_AT_MOST_S && registrations.messages > 0, "{kept}");
    assert_opens_elsewhere(&recovered);
}
