//! `/livez` and `/readyz`: one line of reason for each check.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use schemars::JsonSchema;
use serde::Serialize;

/// One thing that must be well, and how it is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Check {
    /// What is checked: `recorder`, `router`, `camera front`.
    pub name: String,
    /// Whether it is well.
    pub ok: bool,
    /// Why, in words for a person; also when it is well.
    pub reason: String,
}

impl Check {
    /// Something that is well.
    #[must_use]
    pub fn pass(name: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { name: name.into(), ok: true, reason: reason.into() }
    }

    /// Something that is not.
    #[must_use]
    pub fn fail(name: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { name: name.into(), ok: false, reason: reason.into() }
    }
}

/// All checks of a service, and what they come to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Health {
    /// `ok` or `failing`.
    pub status: &'static str,
    /// Each with its reason.
    pub checks: Vec<Check>,
}

/// 200 when all checks pass, else 503; the body is a [`Health`].
#[must_use]
pub fn health(checks: Vec<Check>) -> Response {
    let well = checks.iter().all(|check| check.ok);
    let (code, status) =
        if well { (StatusCode::OK, "ok") } else { (StatusCode::SERVICE_UNAVAILABLE, "failing") };
    (code, Json(Health { status, checks })).into_response()
}
