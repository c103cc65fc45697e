//! The follower's routes (contract section 8) on the shared web face.

mod explanations;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Extension, Json, Router};
use http_face::{
    Api, Cameras, Check, Counters, Documents, Events, Health, Operation, Picture, Problem, health,
    metrics_text, page,
};
use ingest::camera_thread::Registered;
use recording::{Command, Journal};
use runtime::link_trouble;
use runtime::session::{Mode, is_router_connected};
use serde_json::json;
use tokio::sync::{Semaphore, watch};
use vision::LandmarkSet;
use waymark_proto::documents::{LandmarkDocument, SetDocument};
use zenoh::Session;

use crate::config::FollowerConfig;
use crate::landmark_feed::LandmarkFeed;
use crate::leader_watch::LeaderWatch;
use crate::metrics;
use crate::pictures_out::{self, Shown};
use crate::post::Post;
use crate::recordings::{self, Shelf};
use crate::station::Station;
use crate::status::{FleetStatus, RecorderStatus, RouterStatus, VehicleStatus};

/// Events kept for a page that was away for a moment.
const EVENTS_KEPT: usize = 1024;

/// Everything that the routes look at; nothing of it can be changed from here but the recorder.
pub(crate) struct Face {
    pub(crate) vehicle: String,
    pub(crate) instance: String,
    pub(crate) started_at: Instant,
    pub(crate) session: Session,
    pub(crate) mode: Mode,
    pub(crate) landmarks: watch::Receiver<Arc<LandmarkSet>>,
    pub(crate) leader: LeaderWatch,
    pub(crate) stations: Vec<Arc<Station>>,
    pub(crate) journal: Arc<Journal>,
    pub(crate) cameras: Arc<Cameras<Shown>>,
    pub(crate) events: Arc<Events>,
    pub(crate) landmark_counters: Arc<crate::counters::LandmarkCounters>,
    pub(crate) recordings: PathBuf,
    pub(crate) search: vision::Mode,
    /// Explanations worked on at once: each takes a core for some 50 ms.
    pub(crate) explainers: Arc<Semaphore>,
}

/// All routes of a follower.
pub(crate) fn routes(face: &Arc<Face>) -> Router {
    let api = Api::new("Waymark follower", env!("CARGO_PKG_VERSION"));
    let api = face.cameras.routes(service_routes(api, face));
    let api = explanations::routes(api, face);
    let api = recordings::routes(landmarks(api, face), Shelf::new(&face.recordings));
    api.undescribed(page()).finish()
}

fn service_routes(api: Api, face: &Arc<Face>) -> Api {
    let shared = || Arc::clone(face);
    let alive = Operation::get("Whether the process answers").gives::<Health>();
    let is_ready = Operation::get("Whether everything is well, with a reason for each check")
        .gives::<Health>()
        .gives_with::<Health>(503);
    let figures = Operation::get("Figures for Prometheus").answers("text/plain", json!({ "type": "string" }));
    let status_of = Operation::get("How the vehicle is").gives::<VehicleStatus>();
    let fleet_of = Operation::get("Everyone who is announced in the fleet").gives::<FleetStatus>();
    let recorder_of = Operation::get("How the recorder is").gives::<RecorderStatus>();
    let commands = json!({ "type": "string", "enum": ["start", "stop", "split"] });
    let command_of = Operation::post("Tells the recorder to start, to stop, or to begin a new file")
        .path("command", "What to do", commands)
        .gives_with::<RecorderStatus>(202)
        .problem(404, "There is no such command");
    let events_of =
        Operation::get("Each registered frame as a server-sent event; Last-Event-ID goes on from there")
            .answers("text/event-stream", json!({ "type": "string" }))
            .problem(503, "Too many read them already");
    api.route("/livez", [alive], get(|| async { health(vec![Check::pass("process", "answers")]) }))
        .route("/readyz", [is_ready], get(ready).with_state(shared()))
        .route("/metrics", [figures], get(metrics).with_state(shared()))
        .route("/api/v1/status", [status_of], get(status).with_state(shared()))
        .route("/api/v1/fleet", [fleet_of], get(fleet).with_state(shared()))
        .route("/api/v1/recorder", [recorder_of], get(recorder).with_state(shared()))
        .route("/api/v1/recorder/{command}", [command_of], post(command).with_state(shared()))
        .route("/api/v1/events", [events_of], get(events).with_state(shared()))
}

impl Face {
    pub(crate) fn new(
        config: &FollowerConfig,
        instance: String,
        session: &Session,
        feed: &LandmarkFeed,
        leader: LeaderWatch,
        posts: &[Post],
        journal: &Arc<Journal>,
    ) -> Self {
        let cameras = Cameras::new(
            config.cameras.clone(),
            pictures_out::LAYERS,
            pictures_out::depiction(feed.landmarks()),
        );
        Self {
            vehicle: config.vehicle.clone(),
            instance,
            started_at: Instant::now(),
            session: session.clone(),
            mode: config.zenoh.mode,
            landmarks: feed.landmarks(),
            leader,
            stations: posts.iter().map(Post::station).collect(),
            journal: Arc::clone(journal),
            cameras: Arc::new(cameras),
            events: Arc::new(Events::new(EVENTS_KEPT)),
            landmark_counters: feed.counters(),
            recordings: config.recorder.directory.clone(),
            search: config.follow_options().mode,
            explainers: Arc::new(Semaphore::new(1)),
        }
    }

    /// Whether there is a way to the others. A peer that is connected is one only for peers: elsewhere it is this
    /// vehicle's own camera.
    pub(crate) async fn connected(&self) -> bool {
        let with_peers = self.mode == Mode::Peer;
        is_router_connected(&self.session).await
            || (with_peers && self.session.info().peers_zid().await.next().is_some())
    }

    pub(crate) async fn status(&self) -> VehicleStatus {
        VehicleStatus {
            vehicle: self.vehicle.clone(),
            role: "follower",
            version: env!("CARGO_PKG_VERSION"),
            uptime_s: self.started_at.elapsed().as_secs_f64(),
            leader: self.leader.status(),
            router: RouterStatus { connected: self.connected().await },
            landmarks: self.landmarks.borrow().landmarks.len(),
            cameras: self.stations.iter().map(|station| station.status()).collect(),
            recorder: RecorderStatus::from(self.journal.status()),
        }
    }

    /// Shows a registered frame to whoever looks.
    pub(crate) fn show(&self, station: &Station, registered: Arc<Registered>) {
        station.count_frame(registered.finished_at);
        let places = station.places(&registered);
        let status = station.status_with(Some((&registered, &places)));
        if let Err(error) = self.events.publish("camera", &status) {
            tracing::error!(%error, "an event could not be written as JSON");
        }
        if let Some(feed) = self.cameras.feed(station.id()) {
            feed.publish(Picture {
                sequence: registered.outcome.sequence,
                captured_at_ns: registered.outcome.captured_at.nanos,
                received_at: registered.finished_at.into(),
                source: Arc::new(Shown { registered, places }),
            });
        }
    }

    async fn checks(&self) -> Vec<Check> {
        let mut checks = vec![match self.connected().await {
            true => Check::pass("router", "connected"),
            false => Check::fail("router", link_trouble::no_router()),
        }];
        checks.extend(self.stations.iter().map(|station| match station.liveness() {
            Ok(age) => Check::pass(
                format!("camera {}", station.id()),
                format!("{:.0} ms old", age.as_secs_f64() * 1e3),
            ),
            Err(reason) => Check::fail(format!("camera {}", station.id()), reason),
        }));
        let recorder = self.journal.status();
        checks.push(match recorder.state {
            recording::State::Failed => Check::fail("recorder", recorder.reason.unwrap_or_default()),
            recording::State::Recording => Check::pass("recorder", "recording"),
            recording::State::Off => Check::pass("recorder", "off"),
        });
        checks
    }
}

type Shared = State<Arc<Face>>;

async fn ready(State(face): Shared) -> Response {
    health(face.checks().await)
}

async fn metrics(State(face): Shared, Extension(refusals): Extension<Arc<Counters>>) -> Response {
    let status = face.status().await;
    let text = metrics::exposition(
        &status,
        &face.leader.fleet().status(),
        &face.stations,
        &face.landmark_counters,
        &face.cameras,
        &refusals,
    );
    metrics_text(text)
}

async fn status(State(face): Shared) -> Json<VehicleStatus> {
    Json(face.status().await)
}

async fn fleet(State(face): Shared) -> Json<FleetStatus> {
    Json(face.leader.fleet().status())
}

async fn recorder(State(face): Shared) -> Json<RecorderStatus> {
    Json(face.journal.status().into())
}

async fn command(State(face): Shared, Path(command): Path<String>) -> Result<Response, Problem> {
    let command = match command.as_str() {
        "start" => Command::Start,
        "stop" => Command::Stop,
        "split" => Command::Split,
        other => return Err(Problem::not_found(&format!("recorder command {other:?}"))),
    };
    let _counted_by_the_journal = face.journal.command(command);
    Ok((StatusCode::ACCEPTED, Json(RecorderStatus::from(face.journal.status()))).into_response())
}

async fn events(State(face): Shared, headers: HeaderMap) -> Result<Response, Problem> {
    face.events.respond(&headers)
}

/// The landmarks in force.
fn landmarks(api: Api, face: &Arc<Face>) -> Api {
    const LANDMARKS: Documents = Documents {
        kind: "landmark",
        about_all: "The landmarks that are looked for",
        about_one: "One of them",
    };
    let in_force = face.landmarks.clone();
    let (all, all_answer) = LANDMARKS.all(move || SetDocument::from(in_force.borrow().as_ref()));
    let in_force = face.landmarks.clone();
    let (one, one_answer) = LANDMARKS.one(move |id| LandmarkDocument::in_set(&in_force.borrow(), id));
    api.route("/api/v1/landmarks", [all], all_answer).route("/api/v1/landmarks/{id}", [one], one_answer)
}
