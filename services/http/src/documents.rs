//! JSON documents as routes: a whole collection and each of it by name, with entity tags.

use std::sync::Arc;

use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::Operation;
use crate::conditional::{conditional, entity_tag};
use crate::problem::Problem;

/// What is said of a route, and who answers there.
pub type Served = (Operation, MethodRouter);

/// A collection of documents of one kind.
#[derive(Clone, Copy, Debug)]
pub struct Documents {
    /// What one of them is, for those who ask for something else.
    pub kind: &'static str,
    /// What the collection is.
    pub about_all: &'static str,
    /// What each of them is.
    pub about_one: &'static str,
}

impl Documents {
    /// Answers with what `all` gives.
    pub fn all<T: Serialize + JsonSchema>(
        self,
        all: impl Fn() -> T + Clone + Send + Sync + 'static,
    ) -> Served {
        let answer = get(move |request: HeaderMap| async move { document(&request, &all()) });
        (described(self.about_all).gives::<T>(), answer)
    }

    /// Answers with the one whose `id` stands in the path.
    pub fn one<T: Serialize + JsonSchema>(
        self,
        one: impl Fn(&str) -> Option<T> + Send + Sync + 'static,
    ) -> Served {
        let one = Arc::new(one);
        let answer = get(move |Path(id): Path<String>, request: HeaderMap| async move {
            match one(&id) {
                Some(found) => document(&request, &found),
                None => Problem::not_found(&format!("{} {id:?}", self.kind)).into_response(),
            }
        });
        let id = serde_json::json!({ "type": "string" });
        (
            described(self.about_one).path("id", "Its id", id).gives::<T>().problem(404, "There is none"),
            answer,
        )
    }
}

fn described(summary: &'static str) -> Operation {
    Operation::get(summary).empty(304)
}

fn document(request: &HeaderMap, value: &impl Serialize) -> Response {
    match serde_json::to_vec(value) {
        Ok(content) => conditional(request, &entity_tag(&content), "application/json", content.into()),
        Err(error) => Problem::internal(&error).into_response(),
    }
}
