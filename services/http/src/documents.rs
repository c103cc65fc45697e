//! Named JSON documents as routes.

use std::sync::Arc;

use axum::Router;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use serde_json::Value;

use crate::conditional::{conditional, entity_tag};
use crate::problem::Problem;

/// Routes for a collection: `path` answers with `all` documents in one, `path/{id}` with `one` of them; both with an
/// entity tag. `kind` names what there is, for those who ask for something else.
pub fn documents(
    kind: &'static str,
    path: &str,
    all: impl Fn() -> Value + Send + Sync + 'static,
    one: impl Fn(&str) -> Option<Value> + Send + Sync + 'static,
) -> Router {
    let (all, one) = (Arc::new(all), Arc::new(one));
    let single = move |Path(id): Path<String>, request: HeaderMap| {
        let found = one(&id).ok_or_else(|| Problem::not_found(&format!("{kind} {id:?}")));
        async move { found.map_or_else(IntoResponse::into_response, |found| document(&request, &found)) }
    };
    Router::new()
        .route(path, get(move |request: HeaderMap| async move { document(&request, &all()) }))
        .route(&format!("{path}/{{id}}"), get(single))
}

fn document(request: &HeaderMap, value: &Value) -> Response {
    let content = value.to_string().into_bytes();
    conditional(request, &entity_tag(&content), "application/json", content.into())
}
