//! The leader's routes (contract section 8) on the shared web face.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use axum::routing::get;
use axum::{Extension, Json, Router};
use http_face::{Check, Counters, documents, health, metrics_text, page};
use metrics::{counter, gauge};
use metrics_exporter_prometheus::PrometheusBuilder;
use runtime::Identity;
use runtime::link_trouble;
use runtime::session::is_router_connected;
use tokio::sync::watch;
use waymark_proto::documents::{landmark_document, set_document};
use zenoh::Session;

use crate::publication::Publication;
use crate::put_times::PutTimes;
use crate::status::{EditCounts, LeaderStatus, RouterStatus, SetStatus};

/// Everything that the routes look at.
pub(crate) struct Face {
    pub(crate) vehicle: String,
    pub(crate) identity: Identity,
    pub(crate) session: Session,
    pub(crate) publications: watch::Receiver<Publication>,
    pub(crate) edits: watch::Receiver<EditCounts>,
    pub(crate) put_times: Arc<PutTimes>,
}

type Shared = State<Arc<Face>>;

/// All routes of a leader.
pub(crate) fn routes(face: Arc<Face>) -> Router {
    Router::new()
        .route("/livez", get(|| async { health(&[Check::pass("process", "answers")]) }))
        .route("/readyz", get(ready))
        .route("/metrics", get(metrics))
        .route("/api/v1/status", get(status))
        .with_state(Arc::clone(&face))
        .merge(landmarks(face))
        .merge(page())
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
            cameras: [],
        }
    }
}

async fn ready(State(face): Shared) -> Response {
    let router = match is_router_connected(&face.session).await {
        true => Check::pass("router", "connected"),
        false => Check::fail("router", link_trouble::no_router()),
    };
    health(&[router])
}

async fn status(State(face): Shared) -> Json<LeaderStatus> {
    Json(face.status().await)
}

/// A recorder of its own for each scrape: two services in one process never mix their figures.
async fn metrics(State(face): Shared, Extension(refusals): Extension<Arc<Counters>>) -> Response {
    let status = face.status().await;
    let recorder = PrometheusBuilder::new().build_recorder();
    metrics::with_local_recorder(&recorder, || {
        gauge!("waymark_uptime_seconds").set(status.uptime_s);
        gauge!("waymark_landmarks").set(status.landmarks as f64);
        gauge!("waymark_landmark_set_epoch").set(status.set.epoch as f64);
        gauge!("waymark_landmark_set_version").set(status.set.version as f64);
        gauge!("waymark_router_connected").set(f64::from(u8::from(status.router.connected)));
        counter!("waymark_landmark_edits_total", "result" => "made").absolute(status.edits.made);
        counter!("waymark_landmark_edits_total", "result" => "refused").absolute(status.edits.refused);
        counter!("waymark_puts_total").absolute(status.puts.count);
        gauge!("waymark_put_seconds_median").set(status.puts.median_ms * 1e-3);
        gauge!("waymark_put_seconds_longest").set(status.puts.longest_ms * 1e-3);
        for (reason, count) in refusals.by_reason() {
            counter!("waymark_http_refused_total", "reason" => reason).absolute(count);
        }
    });
    metrics_text(recorder.handle().render())
}

/// The landmarks in force.
fn landmarks(face: Arc<Face>) -> Router {
    let set = move || Arc::clone(&face.publications.borrow().set);
    let of_one = set.clone();
    documents(
        "landmark",
        "/api/v1/landmarks",
        move || set_document(&set()),
        move |id| {
            of_one().landmarks.iter().find(|landmark| landmark.id == id).map(|it| landmark_document(it))
        },
    )
}
