//! `/api/v1/landmarks`: what is published, and how it is changed.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode};
use axum::routing::put;
use http_face::{Api, Documents, Operation, Problem, json_body};
use serde_json::json;
use vision::SetVersion;
use waymark_proto::documents::{LandmarkDocument, SetDocument, VersionDocument};

use super::{Face, Shared};
use crate::book::{Edit, RefusedEdit};
use crate::handle::EditError;

const LANDMARKS: Documents =
    Documents { kind: "landmark", about_all: "The landmarks that are published", about_one: "One of them" };

pub(super) fn routes(api: Api, face: &Arc<Face>) -> Api {
    let published = face.publications.clone();
    let (all, all_answer) = LANDMARKS.all(move || SetDocument::from(published.borrow().set.as_ref()));
    let published = face.publications.clone();
    let (one, one_answer) = LANDMARKS.one(move |id| LandmarkDocument::in_set(&published.borrow().set, id));
    let id = || json!({ "type": "string", "pattern": "^[a-z0-9][a-z0-9_-]{0,62}$" });
    let publish_of = Operation::put("Publishes a landmark, or puts it in the place of the one with this id")
        .path("id", "Its id", id())
        .takes::<LandmarkDocument>()
        .gives::<VersionDocument>();
    let retire_of = Operation::delete("Retires a landmark: no follower looks for it any more")
        .path("id", "Its id", id())
        .gives::<VersionDocument>()
        .problem(404, "There is none");
    let changes = put(publish).delete(retire).with_state(Arc::clone(face));
    api.route("/api/v1/landmarks", [all], all_answer).route(
        "/api/v1/landmarks/{id}",
        [one, publish_of, retire_of],
        one_answer.merge(changes),
    )
}

async fn publish(
    State(face): Shared,
    Path(id): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<VersionDocument>, Problem> {
    let mut document: LandmarkDocument = json_body(&headers, &body)?;
    if document.id.is_empty() {
        document.id.clone_from(&id);
    }
    if document.id != id {
        let detail = format!("the body's id is {:?}; it must be {id:?}, as in the address", document.id);
        return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, detail));
    }
    let landmark = document
        .draft()
        .map_err(|invalid| Problem::new(StatusCode::UNPROCESSABLE_ENTITY, invalid.to_string()))?;
    make(&face, Edit { publish: vec![landmark], ..Edit::default() }).await
}

async fn retire(State(face): Shared, Path(id): Path<String>) -> Result<Json<VersionDocument>, Problem> {
    make(&face, Edit { retire: vec![id], ..Edit::default() }).await
}

async fn make(face: &Face, edit: Edit) -> Result<Json<VersionDocument>, Problem> {
    match face.desk.edit(edit).await {
        Ok(SetVersion { epoch, version }) => Ok(Json(VersionDocument { epoch, version })),
        Err(EditError::Refused(refused @ RefusedEdit::NotThere { .. })) => {
            Err(Problem::new(StatusCode::NOT_FOUND, refused.to_string()))
        }
        Err(EditError::Refused(refused)) => Err(Problem::new(StatusCode::CONFLICT, refused.to_string())),
        Err(EditError::Ended) => {
            Err(Problem::unavailable("the leader is ending", std::time::Duration::from_secs(2)))
        }
    }
}
