//! `waymark doctor`, before a sound convoy and before every fault that it is to find.

use std::net::TcpListener;
use std::path::Path;
use std::time::Duration;

use ::camera::CameraConfig;
use runtime::identity::unix_time_ns;
use runtime::{SessionSettings, Shutdown};
use serde_json::Value;
use vision::Timestamp;
use waymark_proto::images::{PictureFormat, picture_message};
use waymark_proto::payload::WireMessage;

use crate::convoy::{Convoy, free_address, setting};
use crate::program::{Ran, waymark};

/// What the doctor found.
struct Findings {
    ran: Ran,
    report: Value,
}

impl Findings {
    /// Verdict, finding and remedy of the first check whose name begins so.
    #[track_caller]
    fn of(&self, check: &str) -> [&str; 3] {
        let checks = self.report["checks"].as_array().unwrap();
        let found = checks.iter().find(|found| found["check"].as_str().unwrap().starts_with(check));
        let found = found.unwrap_or_else(|| panic!("no check {check}: {}", self.report));
        ["verdict", "found", "remedy"].map(|part| found[part].as_str().unwrap_or_default())
    }

    #[track_caller]
    fn says(&self, check: &str, verdict: &str, words: &str) {
        let [judged, found, remedy] = self.of(check);
        assert_eq!(judged, verdict, "{check}: {found}");
        assert!(found.contains(words), "{check}: {found}");
        assert_eq!(!remedy.is_empty(), verdict == "no", "{check}: {remedy}");
    }
}

/// The doctor's view of a follower whose router is at `endpoint`.
fn examined(endpoint: &str, directory: &Path, settings: &[&str], code: i32) -> Findings {
    let own = [
        format!("zenoh.connect=[\"{endpoint}\"]"),
        format!("http.listen={}", free_address()),
        setting("state_dir", &directory.join("state")),
        setting("recorder.directory", &directory.join("recordings")),
        "recorder.min_free_bytes=0".to_owned(),
    ];
    let settings = own.iter().map(String::as_str).chain(settings.iter().copied());
    let set = settings.flat_map(|setting| ["--set", setting]);
    let ran = waymark(["doctor", "--json"].into_iter().chain(set)).ended(code);
    let report = serde_json::from_str(&ran.stdout).unwrap();
    Findings { ran, report }
}

impl Convoy {
    fn examined(&self, settings: &[&str], code: i32) -> Findings {
        examined(&self.endpoint, self.directory.path(), settings, code)
    }
}

#[test]
fn a_sound_convoy_is_found_sound() {
    let convoy = Convoy::with_router();
    let leader = convoy.lead(convoy.session());
    let (session, stop) = (convoy.session(), Shutdown::new());
    let config = CameraConfig { source: "sim:rink?seed=1&fps=10".to_owned(), ..CameraConfig::default() };
    let camera = convoy.spawn(::camera::run(config, session, stop.clone()));
    let findings = convoy.examined(&[], 0);
    assert_eq!(findings.report["fine"], true, "{}", findings.report);
    assert_eq!(findings.report["service"], "follower");
    for (check, words) in [
        ("router", "reached in"),
        ("publications", "come back through the router"),
        ("clock of leader/leader", "give or take"),
        ("versions", "all run"),
        ("landmarks", "1 of leader leader"),
        ("camera front", "ms old"),
        ("port of the page", "free"),
        ("state directory", "can be written"),
        ("disk space", "enough for"),
        ("disk speed", "MB/s"),
    ] {
        findings.says(check, "yes", words);
    }
    stop.request();
    convoy.block_on(camera).unwrap().unwrap();
    // The leader's own port is taken, by the leader.
    let (page, router) =
        (format!("http.listen={}", leader.page()), format!("zenoh.connect=[\"{}\"]", convoy.endpoint));
    let told = waymark(["doctor", "leader", "--set", &page, "--set", &router]).ended(0).stdout;
    assert!(told.contains("this service runs there, version"), "{told}");
    assert!(told.contains("n/a  cameras"), "{told}");
}

#[test]
fn without_a_router_it_says_so_and_looks_at_the_rest() {
    let directory = tempfile::tempdir().unwrap();
    let endpoint = format!("tcp/{}", free_address());
    let findings = examined(&endpoint, directory.path(), &["zenoh.open_timeout_s=0.3"], 1);
    findings.says("router", "no", &endpoint);
    assert!(findings.of("router")[2].contains("waymark router"));
    for unseen in ["publications", "clocks", "versions", "landmarks", "cameras"] {
        findings.says(unseen, "not-applicable", "nobody is reached");
    }
    findings.says("disk speed", "yes", "MB/s");
    assert!(!directory.path().join("recordings").exists(), "the doctor left something behind");
}

#[test]
fn a_taken_port_is_found() {
    let convoy = Convoy::with_router();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let page = format!("http.listen={}", taken.local_addr().unwrap());
    // Whoever accepts and hangs up at once answers nothing that is ours.
    let hang_up = std::thread::spawn(move || drop(taken.accept()));
    let endpoint = format!("zenoh.listen=[\"{}\"]", convoy.endpoint);
    let findings = convoy.examined(&[&page, &endpoint], 1);
    findings.says("port of the page", "no", "taken by another program");
    findings.says("port of Zenoh", "no", "taken by another program");
    hang_up.join().unwrap();
}

#[test]
fn a_directory_that_cannot_be_written_is_found() {
    let convoy = Convoy::with_router();
    // Nobody may make files there, not even root.
    let findings = convoy.examined(&["recorder.directory=/proc/waymark", "state_dir=/proc/waymark"], 1);
    findings.says("disk speed", "no", "/proc");
    findings.says("state directory", "no", "/proc");
    let findings = convoy.examined(&["recorder.min_free_bytes=9000000000000000000"], 1);
    findings.says("disk space", "no", "free");
}

#[test]
fn members_of_another_version_and_silent_ones_are_found() {
    let convoy = Convoy::with_router();
    let session = convoy.session();
    let _old = convoy.announce(&session, "old", "0.0.1");
    let silent = "@waymark/v1/convoy/stopped/follower/1";
    let _silent = convoy.block_on(async { session.liveliness().declare_token(silent).await.unwrap() });
    let findings = convoy.examined(&[], 1);
    findings.says("versions", "no", "old/follower runs 0.0.1");
    findings.says("clock of old/follower", "yes", "give or take");
    findings.says("clock of stopped/follower", "no", "does not answer");
}

#[test]
fn cameras_that_are_silent_or_late_are_found() {
    let convoy = Convoy::with_router();
    let (session, stop) = (convoy.session(), Shutdown::new());
    let late = convoy.spawn({
        let stop = stop.clone();
        async move {
            let mut tick = tokio::time::interval(Duration::from_millis(100));
            while !stop.is_requested() {
                tick.tick().await;
                let captured_at = Timestamp::from_nanos(unix_time_ns() - 60_000_000_000);
                let picture =
                    picture_message(PictureFormat::Jpeg, b"jpeg".as_slice().into(), captured_at, "rear");
                let key = "waymark/v1/convoy/follower/camera/rear/image";
                let encoding = <waymark_proto::foxglove::CompressedImage as WireMessage>::encoding();
                session.put(key, prost::Message::encode_to_vec(&picture)).encoding(encoding).await.unwrap();
            }
        }
    });
    let findings = convoy.examined(&["cameras=[\"front\", \"rear\"]"], 1);
    findings.says("camera front", "no", "no picture within");
    findings.says("camera rear", "no", "60.");
    stop.request();
    convoy.block_on(late).unwrap();
    findings.says("landmarks", "no", "no answer from the leader");
}

#[test]
fn a_service_that_names_nobody_has_nobody_to_reach() {
    let directory = tempfile::tempdir().unwrap();
    let findings = examined("tcp/127.0.0.1:1", directory.path(), &["zenoh.connect=[]"], 0);
    findings.says("router", "not-applicable", "names nobody");
    assert!(findings.ran.stderr.contains("examining follower"), "{}", findings.ran.stderr);
}

#[test]
fn a_configuration_that_is_none_is_a_usage_error() {
    waymark(["doctor", "--set", "vehicle=\"A B\""]).ended(2).telling("vehicle is \"A B\"");
    waymark(["doctor", "leader", "--set", "htpp.listen=1"]).ended(2).telling("did you mean \"http\"?");
    let settings = SessionSettings { file: Some("no-such.json5".into()), ..SessionSettings::default() };
    assert!(settings.check().is_err());
}
