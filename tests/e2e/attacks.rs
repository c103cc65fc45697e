//! Clients of a follower's web face that mean no good, or do not do their part: they get their answer, everybody else is
//! served, registration and recorder go on, and what was refused is counted.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::unix::fs::symlink;

use tests::face::Face;
use tests::{DEADLINE, until};

use crate::convoy::{Place, Vehicle};

const RECORDING: &str = "follower-20240301T000000Z-0001.mcap";

/// Memory may grow by so much, whatever is done to it.
const MOST_GROWTH_KIB: u64 = 64 << 10;

/// Sends `request` as it stands and gives the answer, as far as it comes.
fn raw(face: &Face, request: &[u8]) -> String {
    let mut client = connected(face);
    // An answer that comes before everything is sent ends the sending.
    let _cut_short = client.write_all(request);
    let mut answer = Vec::new();
    let _reset_after_the_answer = client.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

fn connected(face: &Face) -> TcpStream {
    let client = TcpStream::connect(face.address()).unwrap();
    client.set_read_timeout(Some(DEADLINE)).unwrap();
    client
}

fn ask(face: &Face, method: &str, target: &str, headers: &str) -> String {
    raw(face, format!("{method} {target} HTTP/1.1\r\nConnection: close\r\n{headers}\r\n\r\n").as_bytes())
}

fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0)
}

/// How many were turned away or cut off for this reason.
fn refused(face: &Face, reason: &str) -> u64 {
    let metrics = String::from_utf8(face.get("/metrics").body).unwrap();
    let name = format!("waymark_http_refused_total{{reason=\"{reason}\"}} ");
    metrics.lines().find_map(|line| line.strip_prefix(&name)?.parse().ok()).unwrap_or(0)
}

fn resident_kib(vehicle: &Vehicle) -> u64 {
    let told = fs::read_to_string(format!("/proc/{}/status", vehicle.program.id())).unwrap();
    let line = told.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

#[test]
fn viewers_that_never_read_and_clients_that_never_finish_asking_hold_up_nobody() {
    let place = Place::new();
    let _router = place.start_router();
    let vehicle = place.start_vehicle("follower", &["recorder.enabled=false"]);
    let face = &vehicle.face;
    vehicle.await_frames(3);
    let before_kib = resident_kib(&vehicle);
    let motion = b"GET /api/v1/cameras/front/stream.mjpeg HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let half = b"GET / HTTP/1.1\r\nHost: loc";
    let clients: Vec<TcpStream> = [(200, &motion[..]), (500, &half[..])]
        .into_iter()
        .flat_map(|(count, request)| std::iter::repeat_n(request, count))
        .map(|request| {
            let mut client = connected(face);
            client.write_all(request).unwrap();
            client
        })
        .collect();
    until("streams beyond the cap are refused", || (refused(face, "streams") >= 184).then_some(()));
    let late = ask(face, "GET", "/api/v1/cameras/front/stream.mjpeg", "Host: localhost");
    assert!(status(&late) == 503 && late.contains("\r\nretry-after: "), "{late}");
    vehicle.await_frames(20);
    assert_eq!(face.get("/livez").status, 200);
    until("half a request is cut off", || (refused(face, "slow_header") >= 500).then_some(()));
    for mut client in clients.into_iter().skip(200) {
        let mut rest = Vec::new();
        // Ends: with an answer, without one, or with a reset.
        let _ended = client.read_to_end(&mut rest);
        assert!(rest.is_empty() || rest.starts_with(b"HTTP/1.1 408"), "{}", String::from_utf8_lossy(&rest));
    }
    let grown_kib = resident_kib(&vehicle).saturating_sub(before_kib);
    assert!(grown_kib <= MOST_GROWTH_KIB, "{grown_kib} KiB");
}

#[test]
fn names_lead_nowhere_but_to_recordings() {
    let place = Place::new();
    let _router = place.start_router();
    let vehicle = place.start_vehicle("follower", &[]);
    let recordings = place.directory.path().join("follower-recordings");
    vehicle.await_frames(3);
    let outside = place.directory.path().join("outside.mcap");
    fs::write(&outside, "outside").unwrap();
    symlink(&outside, recordings.join(RECORDING)).unwrap();
    let names = [
        RECORDING,
        "../outside.mcap",
        "..%2foutside.mcap",
        "%2e%2e%2foutside.mcap",
        "%2e%2e/outside.mcap",
        "outside.mcap%00",
        "%00",
        "....//outside.mcap",
    ];
    for name in names {
        for (method, target) in [
            ("GET", format!("/api/v1/recordings/{name}")),
            ("DELETE", format!("/api/v1/recordings/{name}")),
            ("GET", format!("/api/v1/recordings/{name}/frames/0.jpg")),
            ("GET", format!("/api/v1/recordings/{name}/landmarks")),
            ("GET", format!("/{name}")),
        ] {
            let answer = ask(&vehicle.face, method, &target, "Host: localhost");
            assert!(matches!(status(&answer), 404 | 405), "{method} {target}: {answer}");
            assert!(answer.contains("\r\ncontent-type: application/problem+json"), "{target}: {answer}");
            assert!(!answer.contains("outside\r") && !answer.ends_with("outside"), "{target}: {answer}");
        }
    }
    assert_eq!(fs::read_to_string(&outside).unwrap(), "outside");
    let listed = vehicle.face.json("/api/v1/recordings");
    assert!(!listed.to_string().contains(RECORDING), "{listed}");
}

#[test]
fn too_much_is_refused_and_other_sites_change_nothing() {
    let place = Place::new();
    let _router = place.start_router();
    let vehicle = place.start_vehicle("follower", &[]);
    let face = &vehicle.face;
    face.polled("/api/v1/recorder", |recorder| recorder["state"] == "recording");
    vehicle.await_frames(3);
    let long = format!("/livez?{}", "a".repeat(64 << 10));
    let large = format!("Host: localhost\r\nContent-Length: {0}\r\n\r\n{1}", 3 << 20, "x".repeat(3 << 20));
    let stop = "/api/v1/recorder/stop";
    let cases = [
        ("GET", long.as_str(), "Host: localhost", &[414, 431][..]),
        ("GET", "/api/v1/cameras/front/overlay.jpg?width=1e9", "Host: localhost", &[400]),
        ("POST", stop, large.as_str(), &[413]),
        ("POST", stop, "Host: localhost\r\nOrigin: https://evil.example\r\nContent-Length: 0", &[403]),
        ("POST", stop, "Host: localhost\r\nOrigin: null\r\nContent-Length: 0", &[403]),
        ("POST", stop, "Host: evil.example\r\nContent-Length: 0", &[403]),
        ("GET", "/api/v1/status", "Host: evil.example", &[403]),
    ];
    for (method, target, headers, expected) in cases {
        let answer = ask(face, method, target, headers);
        assert!(expected.contains(&status(&answer)), "{method} {target:.80} {headers:.80}: {answer}");
        assert!(answer.contains("\r\ncontent-type: application/problem+json"), "{answer}");
    }
    for (reason, least) in [("host", 2), ("origin", 2), ("body", 1)] {
        assert!(refused(face, reason) >= least, "{reason}");
    }
    assert!(refused(face, "query") + refused(face, "unparseable") >= 1);
    assert_eq!(face.json("/api/v1/recorder")["state"], "recording");
    vehicle.await_frames(3);
}
