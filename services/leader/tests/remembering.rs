//! A router's store answers for leaders that are gone, also after its own restart.

#![allow(clippy::unwrap_used)] // a test's helpers may fail the test

use std::net::TcpListener;
use std::path::Path;
use std::time::Duration;

use http_face::HttpSettings;
use leader::client::{ClientError, LandmarkClient};
use leader::store::Store;
use leader::{Edit, Leader, LeaderConfig};
use runtime::{SessionSettings, Shutdown};
use tokio::task::JoinHandle;
use tokio::time::timeout;
use vision::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};
use waymark_proto::digest::landmark_digest;
use waymark_proto::keys::VehicleKeys;
use zenoh::Session;

const LONG: Duration = Duration::from_secs(30);

fn landmark(id: &str) -> Landmark {
    let mut landmark = Landmark {
        id: id.into(),
        revision: 0,
        window_px: WindowPx::square(12),
        shades: vec![ColorStats::uniform(100.0, 20.0)],
        tolerance: ColorStats::uniform(15.0, 50.0),
        shape: ShapeClass::Any,
        size_m: None,
        digest: Digest::default(),
    };
    landmark.digest = landmark_digest(&landmark);
    landmark
}

struct Router {
    session: Session,
    shutdown: Shutdown,
    storing: JoinHandle<()>,
    shelf: tokio::sync::watch::Receiver<leader::store::Shelf>,
}

impl Router {
    async fn open(endpoint: &str, directory: &Path) -> Self {
        let session = SessionSettings::router(endpoint).open().await.unwrap();
        let store = Store::open(&session, directory).await.unwrap();
        let (shelf, shutdown) = (store.vehicles(), Shutdown::new());
        let storing = tokio::spawn(store.run(shutdown.clone()));
        Self { session, shutdown, storing, shelf }
    }

    async fn keeps(&mut self, landmarks: usize) {
        let kept = self.shelf.wait_for(|shelf| shelf.vehicles().any(|(_, count)| count == landmarks));
        timeout(LONG, kept).await.expect("the set was not kept").unwrap();
    }

    async fn close(self) {
        self.shutdown.request();
        self.storing.await.unwrap();
        self.session.close().await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_sets_of_leaders_that_left_are_answered_for() {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let place = tempfile::tempdir().unwrap();
    let client = async || {
        let session = SessionSettings::client(&endpoint).open().await.unwrap();
        LandmarkClient::new(session, VehicleKeys::new("convoy", "leader").unwrap())
    };
    let mut router = Router::open(&endpoint, &place.path().join("store")).await;
    assert!(matches!(client().await.list().await, Err(ClientError::NoAnswer { .. })));

    let config = LeaderConfig {
        state_dir: place.path().join("leader"),
        http: HttpSettings::on_loopback(0),
        ..LeaderConfig::default()
    };
    let (session, shutdown) = (SessionSettings::client(&endpoint).open().await.unwrap(), Shutdown::new());
    let leader = Leader::start(&config, session.clone(), shutdown.clone()).await.unwrap();
    let publish = Edit { publish: vec![landmark("red"), landmark("blue")], ..Edit::default() };
    leader.handle().edit(publish).await.unwrap();
    let published = leader.handle().landmarks();
    router.keeps(2).await;
    shutdown.request();
    timeout(LONG, leader.finished()).await.unwrap().unwrap();
    session.close().await.unwrap();
    assert_eq!(client().await.list().await.unwrap(), *published);

    router.close().await;
    let router = Router::open(&endpoint, &place.path().join("store")).await;
    assert_eq!(client().await.list().await.unwrap(), *published);
    router.close().await;
}
