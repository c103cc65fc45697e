//! The leader's routes (contract section 8) on the shared web face.

mod landmarks;
mod lessons;

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use axum::routing::get;
use axum::{Extension, Json, Router};
use http_face::{
    Api, Cameras, Check, Counters, Health, Operation, Picture, PictureFeed, camera_state, health,
    metrics_text, page,
};
use ingest::encoded::EncodedFrame;
use runtime::Identity;
use runtime::link_trouble;
use runtime::session::is_router_connected;
use serde_json::json;
use tokio::sync::{Semaphore, watch};
use zenoh::Session;

use crate::handle::LeaderHandle;
use crate::lessons::Lessons;
use crate::metrics;
use crate::publication::Publication;
use crate::put_times::PutTimes;
use crate::status::{CameraStatus, EditCounts, LeaderStatus, RouterStatus, SetStatus};

/// Everything that the routes look at.
pub(crate) struct Face {
    pub(crate) vehicle: String,
    pub(crate) identity: Identity,
    pub(crate) session: Session,
    pub(crate) publications: watch::Receiver<Publication>,
    pub(crate) edits: watch::Receiver<EditCounts>,
    pub(crate) put_times: Arc<PutTimes>,
    pub(crate) desk: LeaderHandle,
    pub(crate) cameras: Arc<Cameras<EncodedFrame>>,
    pub(crate) camera_ids: Vec<String>,
    pub(crate) lessons: Lessons,
    /// Lessons worked on at once.
    pub(crate) learners: Arc<Semaphore>,
}

type Shared = State<Arc<Face>>;

/// All routes of a leader.
pub(crate) fn routes(face: &Arc<Face>) -> Router {
    let shared = || Arc::clone(face);
    let alive = Operation::get("Whether the process answers").gives::<Health>();
    let is_ready = Operation::get("Whether everything is well, with a reason for each check")
        .gives::<Health>()
        .gives_with::<Health>(503);
    let figures = Operation::get("Figures for Prometheus").answers("text/plain", json!({ "type": "string" }));
    let status_of = Operation::get("How the leader is").gives::<LeaderStatus>();
    let api = Api::new("Waymark leader", env!("CARGO_PKG_VERSION"))
        .route("/livez", [alive], get(|| async { health(vec![Check::pass("process", "answers")]) }))
        .route("/readyz", [is_ready], get(ready).with_state(shared()))
        .route("/metrics", [figures], get(scrape).with_state(shared()))
        .route("/api/v1/status", [status_of], get(status).with_state(shared()));
    let api = lessons::routes(landmarks::routes(face.cameras.routes(api), face), face);
    api.undescribed(page()).finish()
}

impl Face {
    pub(crate) async fn status(&self) -> LeaderStatus {
        let connected = is_router_connected(&self.session).await;
        let set = Arc::clone(&self.publications.borrow().set);
        LeaderStatus {
            vehicle: self.vehicle.clone(),
            role: "leader",
            version: env!("CARGO_PKG_VERSION"),
            instance: self.identity.instance.clone(),
            uptime_s: self.identity.uptime().as_secs_f64(),
            router: RouterStatus { connected },
            landmarks: set.landmarks.len(),
            set: SetStatus { epoch: set.version.epoch, version: set.version.version },
            edits: *self.edits.borrow(),
            puts: self.put_times.status(),
            cameras: self.camera_ids.iter().map(|id| self.camera(id)).collect(),
        }
    }
}

impl Face {
    fn camera(&self, id: &str) -> CameraStatus {
        let newest = self.cameras.feed(id).and_then(PictureFeed::newest);
        let age = newest.as_ref().map(Picture::age);
        CameraStatus {
            id: id.to_owned(),
            state: camera_state(age),
            sequence: newest.map(|newest| newest.sequence),
            age_ms: age.map(|age| age.as_secs_f64() * 1e3),
        }
    }
}

async fn ready(State(face): Shared) -> Response {
    let router = match is_router_connected(&face.session).await {
        true => Check::pass("router", "connected"),
        false => Check::fail("router", link_trouble::no_router()),
    };
    health(vec![router])
}

async fn status(State(face): Shared) -> Json<LeaderStatus> {
    Json(face.status().await)
}

async fn scrape(State(face): Shared, Extension(refusals): Extension<Arc<Counters>>) -> Response {
    metrics_text(metrics::exposition(&face.status().await, &refusals))
}
