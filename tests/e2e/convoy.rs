//! A convoy of processes, for tests that take parts of it away.

use leader::client::LandmarkClient;
use leader::{Edit, Others};
use runtime::SessionSettings;
use tests::face::Face;
use tests::program::Program;
use tests::{free_address, until};
use tokio::runtime::Runtime;
use vision::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};
use waymark_proto::keys::VehicleKeys;
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;

/// A place for a convoy's state, and its router's address.
pub(crate) struct Place {
    pub(crate) endpoint: String,
    pub(crate) directory: tempfile::TempDir,
}

/// A follower whose camera speaks to it alone.
pub(crate) struct Vehicle {
    pub(crate) program: Program,
    pub(crate) face: Face,
    _camera: Program,
}

impl Place {
    pub(crate) fn new() -> Self {
        Self { endpoint: format!("tcp/{}", free_address()), directory: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.directory.path().join(name).display().to_string()
    }

    /// A router that keeps nothing.
    pub(crate) fn start_router(&self) -> Program {
        let router = Program::start(["router", "--listen", &self.endpoint]);
        let _listens = router.note(&self.endpoint);
        router
    }

    /// A router that keeps landmark sets; started again, it has those of before.
    pub(crate) fn start_store(&self) -> Program {
        let router = Program::start(["router", "--listen", &self.endpoint, "--store", &self.path("store")]);
        let _listens = router.note(&self.endpoint);
        router
    }

    /// Waits until the store has this many landmarks of the leader on disk.
    pub(crate) fn await_stored(&self, landmarks: usize) {
        let file = self.directory.path().join("store/convoy.leader.landmarks");
        until("the set is stored", || {
            let stored = std::fs::read(&file).ok()?;
            let set = v1::LandmarkSet::from_payload(&stored).ok()?;
            (set.landmarks.len() == landmarks).then_some(())
        });
    }

    /// A leader or follower with its own state directory, once its web face's address is told.
    pub(crate) fn start_service(&self, role: &str, state: &str, more: &[&str]) -> (Program, Face) {
        let address = free_address();
        let program = self.begin_service(role, state, &address, more);
        let _page = program.note(&address);
        (program, Face::at(&format!("http://{address}")))
    }

    /// The same, without waiting for anything.
    pub(crate) fn begin_service(&self, role: &str, state: &str, address: &str, more: &[&str]) -> Program {
        let settings = [
            connect(&self.endpoint),
            format!("state_dir={}", self.path(state)),
            format!("http.listen={address}"),
        ];
        let more = more.iter().map(|setting| (*setting).to_owned());
        let settings = settings.into_iter().chain(more);
        Program::start(
            [role.to_owned()].into_iter().chain(settings.flat_map(|setting| ["--set".into(), setting])),
        )
    }

    /// A follower that records into its own directory.
    pub(crate) fn start_follower(&self, vehicle: &str, more: &[&str]) -> (Program, Face) {
        let recordings = format!("recorder.directory={}", self.path(&format!("{vehicle}-recordings")));
        let vehicle_setting = format!("vehicle={vehicle}");
        let settings: Vec<&str> =
            [vehicle_setting.as_str(), &recordings].into_iter().chain(more.iter().copied()).collect();
        self.start_service("follower", vehicle, &settings)
    }

    /// A follower with a camera of its own, which needs no router to reach it.
    pub(crate) fn start_vehicle(&self, vehicle: &str, more: &[&str]) -> Vehicle {
        self.start_vehicle_with(vehicle, more, &[])
    }

    /// The same, with settings for the camera too.
    pub(crate) fn start_vehicle_with(&self, vehicle: &str, more: &[&str], camera: &[&str]) -> Vehicle {
        let own = format!("tcp/{}", free_address());
        let listen = format!("zenoh.listen=[\"{own}\"]");
        let settings: Vec<&str> = [listen.as_str()].into_iter().chain(more.iter().copied()).collect();
        let (program, face) = self.start_follower(vehicle, &settings);
        let settings = [
            connect(&own),
            "zenoh.mode=peer".to_owned(),
            format!("vehicle={vehicle}"),
            "source=sim:rink?seed=5&fps=5".to_owned(),
        ];
        let settings = settings.into_iter().chain(camera.iter().map(|setting| (*setting).to_owned()));
        let settings = settings.flat_map(|setting| ["--set".to_owned(), setting]);
        let camera = Program::start(["camera".to_owned()].into_iter().chain(settings));
        Vehicle { program, face, _camera: camera }
    }

    /// Has the leader change its set, as `waymark landmark publish` and `retire` do.
    pub(crate) fn edit(&self, edit: &Edit) {
        let edited = Runtime::new().unwrap().block_on(async {
            let session = SessionSettings::client(&self.endpoint).open().await.unwrap();
            let keys = VehicleKeys::new("convoy", "leader").unwrap();
            LandmarkClient::new(session, keys).edit(edit).await
        });
        edited.unwrap();
    }
}

impl Vehicle {
    /// Waits until it has registered this many more frames.
    pub(crate) fn await_frames(&self, more: u64) {
        let number = |status: &serde_json::Value| status["cameras"][0]["sequence"].as_u64().unwrap_or(0);
        let begin = number(&self.face.json("/api/v1/status"));
        self.face.json_once("/api/v1/status", |status| number(status) >= begin + more);
    }
}

pub(crate) fn connect(endpoint: &str) -> String {
    format!("zenoh.connect=[\"{endpoint}\"]")
}

/// Landmarks that the simulated rink does not show: these tests are about who knows what.
pub(crate) fn landmark(id: &str, red_mean: f32) -> Landmark {
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

pub(crate) fn publish(landmarks: impl Into<Vec<Landmark>>) -> Edit {
    Edit { publish: landmarks.into(), retire: Vec::new(), others: Others::Keep }
}
