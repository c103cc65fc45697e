//! A leader and those who listen to it: real sessions through a router on loopback TCP.

#![allow(clippy::unwrap_used)] // a test's helpers may fail the test

use std::net::TcpListener;
use std::path::Path;
use std::time::Duration;

use http_face::HttpSettings;
use leader::client::{ClientError, LandmarkClient};
use leader::landmark_files::{read_landmarks, write_landmarks};
use leader::{Edit, Leader, LeaderConfig, LeaderError, Others};
use runtime::presence::PresenceError;
use runtime::{SessionSettings, Shutdown};
use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::mpsc;
use tokio::time::timeout;
use vision::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};
use waymark_proto::attachment::Attachment;
use waymark_proto::convert::{landmark_from_wire, manifest_from_wire};
use waymark_proto::digest::landmark_digest;
use waymark_proto::keys::VehicleKeys;
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;
use zenoh::Session;
use zenoh::sample::{Sample, SampleKind};

const LONG: Duration = Duration::from_secs(30);

fn landmark(id: &str, red: f32) -> Landmark {
    let mut landmark = Landmark {
        id: id.into(),
        revision: 0,
        window_px: WindowPx::square(12),
        shades: vec![ColorStats::uniform(red, 20.0)],
        tolerance: ColorStats::uniform(15.0, 50.0),
        shape: ShapeClass::Block,
        size_m: None,
        digest: Digest::default(),
    };
    landmark.digest = landmark_digest(&landmark);
    landmark
}

fn publish(landmarks: &[Landmark]) -> Edit {
    Edit { publish: landmarks.to_vec(), ..Edit::default() }
}

fn retire(id: &str) -> Edit {
    Edit { retire: vec![id.into()], ..Edit::default() }
}

/// A router, and a directory for whatever a test writes.
struct Field {
    endpoint: String,
    place: TempDir,
    _router: Session,
}

impl Field {
    async fn open() -> Self {
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let endpoint = format!("tcp/127.0.0.1:{port}");
        let router = SessionSettings::router(&endpoint).open().await.unwrap();
        Self { endpoint, place: tempfile::tempdir().unwrap(), _router: router }
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.place.path().join(name)
    }

    fn config(&self, state: &str) -> LeaderConfig {
        LeaderConfig {
            state_dir: self.path(state),
            http: HttpSettings::on_loopback(0),
            ..LeaderConfig::default()
        }
    }

    /// A client: it is connected when it opens, so nothing below has to wait for a connection.
    async fn session(&self) -> Session {
        SessionSettings::client(&self.endpoint).open().await.unwrap()
    }

    async fn lead(&self, config: &LeaderConfig) -> Result<(Leader, Shutdown), LeaderError> {
        let shutdown = Shutdown::new();
        let leader = Leader::start(config, self.session().await, shutdown.clone()).await?;
        Ok((leader, shutdown))
    }

    async fn client(&self) -> LandmarkClient {
        LandmarkClient::new(self.session().await, keys())
    }
}

fn keys() -> VehicleKeys {
    VehicleKeys::new("convoy", "leader").unwrap()
}

async fn hear(session: &Session, key: String) -> (mpsc::Receiver<Sample>, zenoh::pubsub::Subscriber<()>) {
    let (heard, waiting) = mpsc::channel(64);
    let callback = move |sample| drop(heard.try_send(sample));
    (waiting, session.declare_subscriber(key).callback(callback).await.unwrap())
}

async fn next(samples: &mut mpsc::Receiver<Sample>) -> Sample {
    timeout(LONG, samples.recv()).await.expect("nothing was heard").unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_late_joiner_is_told_the_set_and_every_edit_changes_it() {
    let field = Field::open().await;
    write_files(&field.path("files"), &[landmark("red", 200.0), landmark("blue", 50.0)]);
    let config = LeaderConfig { landmarks: vec![field.path("files")], ..field.config("state") };
    let (leader, shutdown) = field.lead(&config).await.unwrap();
    let client = field.client().await;
    let ids = |set: &vision::LandmarkSet| -> Vec<(String, u64)> {
        set.landmarks.iter().map(|landmark| (landmark.id.clone(), landmark.revision)).collect()
    };

    let set = client.list().await.unwrap();
    assert_eq!(ids(&set), [("blue".into(), 1), ("red".into(), 1)]);
    assert_eq!(set.version.epoch, 1);

    client.edit(&publish(&[landmark("red", 180.0), landmark("green", 90.0)])).await.unwrap();
    leader.handle().edit(retire("blue")).await.unwrap();
    let changed = client.list().await.unwrap();
    assert_eq!(ids(&changed), [("green".into(), 1), ("red".into(), 2)]);
    assert!(changed.version > set.version);

    let pulled = field.path("pulled");
    write_landmarks(&pulled, &changed).unwrap();
    let push = Edit { others: Others::Retire, ..publish(&read_landmarks(&[pulled]).unwrap()[..1]) };
    client.edit(&push).await.unwrap();
    assert_eq!(ids(&client.list().await.unwrap()), [("green".into(), 1)]);

    shutdown.request();
    let report = timeout(LONG, leader.finished()).await.unwrap().unwrap();
    assert_eq!((report.edits.made, report.edits.refused), (3, 0));
}

#[tokio::test(flavor = "multi_thread")]
async fn those_who_listen_hear_changes_retirements_and_manifests() {
    let field = Field::open().await;
    let listening = field.session().await;
    let (mut landmarks, _heard) = hear(&listening, keys().landmarks()).await;
    let (mut manifests, _heard) = hear(&listening, keys().manifest()).await;
    let (mut statuses, _heard) = hear(&listening, keys().status()).await;
    let (leader, _shutdown) = field.lead(&field.config("state")).await.unwrap();

    // The first second's manifest shows that the way is open.
    let manifest = next(&mut manifests).await;
    assert_eq!(manifest.encoding().to_string(), "application/protobuf;waymark.v1.LandmarkManifest");
    leader.handle().edit(publish(&[landmark("red", 200.0)])).await.unwrap();
    let sample = next(&mut landmarks).await;
    assert_eq!(sample.encoding().to_string(), "application/protobuf;waymark.v1.Landmark");
    assert_eq!(sample.congestion_control(), zenoh::qos::CongestionControl::Drop);
    let attachment = Attachment::from_bytes(&sample.attachment().unwrap().to_bytes()).unwrap();
    assert_eq!(attachment.sequence, 1);
    let wire = v1::Landmark::from_payload(&sample.payload().to_bytes()).unwrap();
    let (heard, epoch) = landmark_from_wire(&wire).unwrap();
    assert_eq!((heard.id.as_str(), heard.revision, epoch), ("red", 1, 1));

    leader.handle().edit(retire("red")).await.unwrap();
    let retired = next(&mut landmarks).await;
    assert_eq!(retired.kind(), SampleKind::Delete);
    assert!(retired.key_expr().as_str().ends_with("/landmark/red"));
    let empty = async {
        loop {
            let wire = v1::LandmarkManifest::from_payload(&next(&mut manifests).await.payload().to_bytes());
            let manifest = manifest_from_wire(&wire.unwrap()).unwrap();
            if (manifest.version.version, manifest.count) == (3, 0) {
                return;
            }
        }
    };
    timeout(LONG, empty).await.expect("no manifest of the empty set");

    let status = v1::VehicleStatus::from_payload(&next(&mut statuses).await.payload().to_bytes()).unwrap();
    assert_eq!((status.role.as_str(), status.vehicle.as_str()), ("leader", "leader"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_restart_keeps_the_set_in_a_higher_epoch() {
    let field = Field::open().await;
    let (leader, shutdown) = field.lead(&field.config("state")).await.unwrap();
    leader.handle().edit(publish(&[landmark("red", 200.0)])).await.unwrap();
    shutdown.request();
    timeout(LONG, leader.finished()).await.unwrap().unwrap();
    let (leader, _shutdown) = field.lead(&field.config("state")).await.unwrap();
    let set = leader.handle().landmarks();
    assert_eq!((set.version.epoch, set.landmarks.len()), (2, 1));
    assert_eq!(field.client().await.list().await.unwrap(), *set);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_impossible_edit_is_refused_with_its_reason_and_changes_nothing() {
    let field = Field::open().await;
    let (leader, _shutdown) = field.lead(&field.config("state")).await.unwrap();
    let client = field.client().await;
    client.edit(&publish(&[landmark("red", 200.0)])).await.unwrap();
    let before = leader.handle().landmarks();
    for (edit, reason) in [
        (publish(&[landmark("red", f32::NAN)]), "publish[0].shades[0].mean[0] is NaN; allowed: 0 to 255"),
        (publish(&[landmark("Red", 1.0)]), "publish[0].id is \"Red\""),
        (retire("green"), "there is no landmark \"green\" to retire; the set has: red"),
    ] {
        let Err(ClientError::Refused { reason: said }) = client.edit(&edit).await else { panic!("{edit:?}") };
        assert!(said.contains(reason), "{said}");
    }
    assert_eq!(leader.handle().landmarks(), before);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_second_leader_of_the_vehicle_is_refused() {
    let field = Field::open().await;
    let (_first, _shutdown) = field.lead(&field.config("first")).await.unwrap();
    let second = timeout(LONG, field.lead(&field.config("second"))).await.unwrap();
    let Err(LeaderError::Presence(PresenceError::AlreadyPresent { .. })) = second else {
        panic!("not refused")
    };
}

#[tokio::test(flavor = "multi_thread")]
async fn an_edit_waits_a_moment_for_a_leader_that_is_just_starting() {
    let field = Field::open().await;
    let client = field.client().await;
    let edit = tokio::spawn(async move { client.edit(&publish(&[landmark("red", 200.0)])).await });
    let (leader, _shutdown) = field.lead(&field.config("state")).await.unwrap();
    edit.await.unwrap().unwrap();
    assert_eq!(leader.handle().landmarks().landmarks.len(), 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn without_a_leader_the_client_says_so() {
    let field = Field::open().await;
    let error = field.client().await.edit(&retire("red")).await.unwrap_err();
    assert!(matches!(error, ClientError::NoAnswer { .. }), "{error}");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_web_face_shows_the_set_and_the_status() {
    let field = Field::open().await;
    let (leader, shutdown) = field.lead(&field.config("state")).await.unwrap();
    leader.handle().edit(publish(&[landmark("red", 200.0)])).await.unwrap();
    let get = async |path: &str| {
        let mut stream = TcpStream::connect(leader.page()).await.unwrap();
        let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).await.unwrap();
        answer
    };
    assert!(get("/livez").await.starts_with("HTTP/1.1 200"));
    assert!(get("/readyz").await.starts_with("HTTP/1.1 200"));
    let landmarks = get("/api/v1/landmarks").await;
    assert!(landmarks.contains("\"id\":\"red\"") && landmarks.contains("etag:"), "{landmarks}");
    assert!(get("/api/v1/landmarks/red").await.starts_with("HTTP/1.1 200"));
    assert!(get("/api/v1/landmarks/none").await.starts_with("HTTP/1.1 404"));
    let status = get("/api/v1/status").await;
    assert!(status.contains("\"role\":\"leader\"") && status.contains("\"landmarks\":1"), "{status}");
    assert!(get("/metrics").await.contains("waymark_landmarks 1"));
    shutdown.request();
    timeout(LONG, leader.finished()).await.unwrap().unwrap();
}

fn write_files(directory: &Path, landmarks: &[Landmark]) {
    let landmarks = landmarks.iter().cloned().map(std::sync::Arc::new).collect();
    let set = vision::LandmarkSet { landmarks, ..vision::LandmarkSet::default() };
    write_landmarks(directory, &set).unwrap();
}
