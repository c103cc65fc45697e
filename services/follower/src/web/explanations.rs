//! Why a landmark is or is not registered in the newest frame, as `waymark explain` says it.

use std::sync::Arc;

use axum::Json;
use axum::extract::{Path, State};
use axum::routing::get;
use http_face::{Api, Operation, Problem};
use ingest::camera_thread;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::json;
use vision::explain::{Comparison, Explanation, explain};
use vision::outcome::Statistic;

use super::{Face, Shared};

/// What decided about a landmark in one frame, nothing known from earlier ones.
#[derive(Serialize, JsonSchema)]
struct ExplanationEntry {
    /// The frame's number in its stream.
    sequence: u64,
    /// Why it was not registered; null when it was.
    reason: Option<String>,
    /// Where it was registered, or came nearest; frame pixels.
    x_px: Option<f32>,
    /// Where it was registered, or came nearest; frame pixels.
    y_px: Option<f32>,
    /// Which of its shades comes nearest there, counted from 1.
    shade: usize,
    /// The six statistics there.
    statistics: Vec<ComparisonEntry>,
}

/// One statistic against the descriptor's.
#[derive(Serialize, JsonSchema)]
struct ComparisonEntry {
    /// Such as `mean red`.
    statistic: String,
    /// `levels` or `levels²`.
    unit: &'static str,
    /// As observed.
    observed: f32,
    /// The descriptor's.
    expected: f32,
    /// How far it may be off.
    tolerance: f32,
    /// How far it is off, in tolerances; null where none is tolerated.
    excess: Option<f32>,
}

pub(super) fn routes(api: Api, face: &Arc<Face>) -> Api {
    let of_landmark = Operation::get("Why a landmark is or is not registered in the newest frame")
        .path("camera", "The camera's id", json!({ "type": "string" }))
        .path("landmark", "The landmark's id", json!({ "type": "string" }))
        .gives::<ExplanationEntry>()
        .problem(404, "There is no such camera or landmark")
        .problem(503, "No picture has arrived yet, or the newest one is stale");
    let answer = get(explained).with_state(Arc::clone(face));
    api.route("/api/v1/cameras/{camera}/explanations/{landmark}", [of_landmark], answer)
}

async fn explained(
    State(face): Shared,
    Path((camera, id)): Path<(String, String)>,
) -> Result<Json<ExplanationEntry>, Problem> {
    let feed = face.cameras.feed(&camera).ok_or_else(|| Problem::not_found(&format!("camera {camera:?}")))?;
    let known = face.landmarks.borrow().landmarks.iter().find(|landmark| landmark.id == id).cloned();
    let landmark = known.ok_or_else(|| Problem::not_found(&format!("landmark {id:?}")))?;
    let newest = feed.latest()?;
    let permit = Arc::clone(&face.explainers).acquire_owned().await;
    let mode = face.search;
    let work = tokio::task::spawn_blocking(move || {
        let _permit = permit;
        let frame = camera_thread::decode(&newest.source.registered.picture)
            .map_err(|error| Problem::internal(&error))?;
        Ok(Json(entry(newest.sequence, &explain(&frame, &landmark, mode))))
    });
    work.await.map_err(|error| Problem::internal(&error))?
}

fn entry(sequence: u64, explanation: &Explanation) -> ExplanationEntry {
    ExplanationEntry {
        sequence,
        reason: explanation.reason(),
        x_px: explanation.at.map(|at| at.x),
        y_px: explanation.at.map(|at| at.y),
        shade: explanation.shade + 1,
        statistics: explanation.statistics.iter().map(comparison).collect(),
    }
}

fn comparison(one: &Comparison) -> ComparisonEntry {
    ComparisonEntry {
        statistic: one.statistic.in_words(),
        unit: if matches!(one.statistic, Statistic::Mean(_)) { "levels" } else { "levels²" },
        observed: one.observed,
        expected: one.expected,
        tolerance: one.tolerance,
        excess: Some(one.excess).filter(|excess| excess.is_finite()),
    }
}
