//! A router in this process, and parts of a convoy around it, for programs to look at.

use std::net::TcpListener;
use std::path::Path;

use http_face::HttpSettings;
use leader::{Edit, Leader, LeaderConfig};
use runtime::presence::{Presence, PresencePlace};
use runtime::{Identity, SessionSettings, Shutdown, StateDir};
use tokio::runtime::Runtime;
use tokio::task::JoinHandle;
use vision::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};
use zenoh::Session;

/// A router, and whatever a test has put around it.
pub(crate) struct Convoy {
    pub(crate) endpoint: String,
    pub(crate) directory: tempfile::TempDir,
    runtime: Runtime,
    _router: Session,
}

/// An address on the loopback that nobody listened on a moment ago.
pub(crate) fn free_address() -> String {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string()
}

impl Convoy {
    pub(crate) fn with_router() -> Self {
        let endpoint = format!("tcp/{}", free_address());
        Self::around(endpoint.clone(), &SessionSettings::router(&endpoint))
    }

    /// Around a router with these settings, which listens on `endpoint`.
    pub(crate) fn around(endpoint: String, router: &SessionSettings) -> Self {
        let runtime = Runtime::new().unwrap();
        let router = runtime.block_on(router.open()).unwrap();
        Self { endpoint, directory: tempfile::tempdir().unwrap(), runtime, _router: router }
    }

    pub(crate) fn block_on<F: Future>(&self, future: F) -> F::Output {
        self.runtime.block_on(future)
    }

    pub(crate) fn spawn<F>(&self, future: F) -> JoinHandle<F::Output>
    where
        F: Future<Output: Send> + Send + 'static,
    {
        self.runtime.spawn(future)
    }

    pub(crate) fn session(&self) -> Session {
        self.block_on(SessionSettings::client(&self.endpoint).open()).unwrap()
    }

    /// A leader that publishes one landmark.
    pub(crate) fn lead(&self, session: Session) -> Leader {
        let config = LeaderConfig {
            state_dir: self.directory.path().join("leader"),
            http: HttpSettings::on_loopback(0),
            ..LeaderConfig::default()
        };
        self.block_on(async {
            let leader = Leader::start(&config, session, Shutdown::new()).await.unwrap();
            let publish = vec![landmark("red")];
            leader.handle().edit(Edit { publish, ..Edit::default() }).await.unwrap();
            leader
        })
    }

    /// Announces a follower that is only a claim, of this version.
    pub(crate) fn announce(&self, session: &Session, vehicle: &str, version: &str) -> Presence {
        let identity = Identity::on(&StateDir::open(&self.directory.path().join(vehicle)).unwrap());
        let siblings = format!("@waymark/v1/convoy/{vehicle}/follower");
        let place = PresencePlace {
            own_key: format!("{siblings}/{}", identity.instance),
            siblings: format!("{siblings}/*"),
        };
        self.block_on(Presence::claim(session, &place, &identity, version)).unwrap()
    }
}

pub(crate) fn landmark(id: &str) -> Landmark {
    let mut landmark = Landmark {
        id: id.to_owned(),
        revision: 0,
        window_px: WindowPx::square(12),
        shades: vec![ColorStats::uniform(120.0, 20.0)],
        tolerance: ColorStats::uniform(15.0, 50.0),
        shape: ShapeClass::Block,
        size_m: None,
        digest: Digest::default(),
    };
    landmark.digest = waymark_proto::digest::landmark_digest(&landmark);
    landmark
}

pub(crate) fn setting(key: &str, path: &Path) -> String {
    format!("{key}={}", path.display())
}
