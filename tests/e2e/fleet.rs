//! Parts of a convoy that leave, stop, come twice, or come back: processes of their own over loopback.

use std::time::Instant;

use runtime::session::LEASE;
use tests::{DEADLINE, free_address, workspace};

use crate::convoy::{Place, landmark, publish};

/// A process that has stopped is taken for gone one lease after its last word, and seen to be a moment later.
#[test]
fn a_leader_that_stops_is_shown_as_gone_and_as_present_when_it_goes_on() {
    let place = Place::new();
    let _router = place.start_router();
    let (leader, _) = place.start_service("leader", "leader", &[]);
    let vehicle = place.start_vehicle("follower", &[]);
    let present = |wanted: bool| {
        vehicle.face.json_once("/api/v1/status", |status| status["leader"]["present"] == wanted);
    };
    present(true);
    let stopped_at = Instant::now();
    leader.freeze();
    present(false);
    eprintln!(
        "figure: leader shown as gone after {:.1} s (lease {LEASE:?})",
        stopped_at.elapsed().as_secs_f64()
    );
    leader.thaw();
    present(true);
}

#[test]
fn a_new_follower_has_the_landmarks_of_a_leader_that_is_gone_for_good() {
    let place = Place::new();
    let router = place.start_store();
    let (leader, _) = place.start_service("leader", "leader", &[]);
    let (_first, first) = place.start_follower("first", &[]);
    place.edit(&publish([landmark("blue", 20.0), landmark("red", 120.0)]));
    let has_both = |status: &serde_json::Value| status["landmarks"] == 2;
    first.polled("/api/v1/status", has_both);
    place.await_stored(2);
    leader.cut_power();
    // What the router keeps survives its own power cut.
    router.cut_power();
    let _router = place.start_store();

    let begin = Instant::now();
    let (_late, late) = place.start_follower("late", &[]);
    let status = late.once_reachable().polled("/api/v1/status", has_both);
    eprintln!("figure: a new follower has the set {:.2} s after its start", begin.elapsed().as_secs_f64());
    assert_eq!(status["leader"]["present"], false, "{status:#}");
    assert!(status["leader"]["age_s"].is_null(), "{status:#}");
}

#[test]
fn a_second_follower_of_the_same_id_is_refused_and_the_first_restarts_after_a_hard_kill() {
    let place = Place::new();
    let _router = place.start_router();
    let (first, _) = place.start_follower("twin", &[]);

    let begin = Instant::now();
    let elsewhere = free_address();
    let recordings = format!("recorder.directory={}", place.path("other-recordings"));
    let second = place.begin_service("follower", "other", &elsewhere, &["vehicle=twin", &recordings]);
    let ended = second.ended_within(DEADLINE);
    eprintln!("figure: a second instance refused after {:.2} s", begin.elapsed().as_secs_f64());
    assert_eq!(ended.code, Some(1), "{}", ended.transcript());
    let said = ended.notes.join("\n");
    assert!(said.contains(&format!("process {}", first.id())), "{said}");

    first.cut_power();
    let begin = Instant::now();
    let (_again, face) = place.start_follower("twin", &[]);
    let status = face.once_reachable().json("/api/v1/status");
    eprintln!("figure: restarted after a hard kill in {:.2} s", begin.elapsed().as_secs_f64());
    assert_eq!(status["vehicle"], "twin");
}

#[test]
fn a_router_killed_pauses_no_registration_and_is_found_again() {
    let place = Place::new();
    let router = place.start_router();
    let (_leader, _) = place.start_service("leader", "leader", &[]);
    let vehicle = place.start_vehicle("follower", &[]);
    vehicle.await_frames(5);
    place.edit(&publish([landmark("red", 120.0)]));
    vehicle.face.json_once("/api/v1/status", |status| status["landmarks"] == 1);

    router.cut_power();
    vehicle.face.json_once("/api/v1/status", |status| status["router"]["connected"] == false);
    vehicle.await_frames(15);
    let _router = place.start_router();
    let began = Instant::now();
    vehicle.face.json_once("/api/v1/status", |status| status["router"]["connected"] == true);
    eprintln!("figure: reconnected {:.2} s after the router's return", began.elapsed().as_secs_f64());
    vehicle.face.json_once("/api/v1/status", |status| status["leader"]["present"] == true);
    place.edit(&publish([landmark("blue", 20.0)]));
    let status = vehicle.face.json_once("/api/v1/status", |status| status["landmarks"] == 2);
    assert_eq!(status["cameras"][0]["dropped"]["missed"], 0, "{status:#}");
}

/// The frozen one has subscriptions whose connection fills up; nobody may wait for it.
#[test]
fn a_follower_that_stops_holds_up_neither_the_other_nor_the_leader() {
    let place = Place::new();
    let _router = place.start_router();
    let (_leader, leader) = place.start_service("leader", "leader", &[]);
    let (one, other) = (place.start_vehicle("one", &[]), place.start_vehicle("other", &[]));
    one.await_frames(1);
    one.program.freeze();
    place.edit(&publish([landmark("red", 120.0)]));
    other.face.json_once("/api/v1/status", |status| status["landmarks"] == 1);
    other.await_frames(15);
    place.edit(&publish([landmark("blue", 20.0)]));
    other.face.json_once("/api/v1/status", |status| status["landmarks"] == 2);
    let puts = leader.json("/api/v1/status")["puts"].clone();
    eprintln!("figure: with a frozen follower the leader's puts took {puts}");
    one.program.thaw();
    one.face.json_once("/api/v1/status", |status| status["landmarks"] == 2);
}

/// The package's own tests need no program of ours; this is the one that speaks to all of them.
#[test]
fn a_late_python_client_receives_the_set_and_then_registrations() {
    let Some(python) = std::env::var_os("WAYMARK_PYTHON") else {
        eprintln!(
            "SKIPPED: WAYMARK_PYTHON names no Python with the waymark package; `tests/run e2e` makes one"
        );
        return;
    };
    let place = Place::new();
    let _router = place.start_router();
    let landmarks = format!("landmarks=[\"{}\"]", workspace().join("tests/containers/landmarks").display());
    let (_leader, _) = place.start_service("leader", "leader", &[&landmarks]);
    let vehicle = place.start_vehicle("follower", &[]);
    vehicle.face.json_once("/api/v1/status", |status| status["landmarks"] == 2);
    let client = std::process::Command::new(python)
        .arg(workspace().join("tests/python/late_client.py"))
        .args([&place.endpoint, "convoy"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&client.stdout);
    assert!(client.status.success(), "{said}\n{}", String::from_utf8_lossy(&client.stderr));
    eprintln!("{said}");
}
