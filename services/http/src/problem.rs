//! Errors as `application/problem+json` (RFC 9457).

use crate::counters::Refusal;
use axum::body::Body;
use axum::http::header::{ALLOW, CONTENT_TYPE, RETRY_AFTER};
use axum::http::{HeaderValue, Response, StatusCode};
use axum::response::IntoResponse;
use schemars::JsonSchema;
use serde_json::{Map, Value, json};
use std::time::Duration;

/// The media type of RFC 9457 section 3.
pub const PROBLEM_JSON: &str = "application/problem+json";

/// Why a request was not answered as asked, in words for a person and members for a program.
///
/// The problem type is `about:blank` (RFC 9457 section 4.2.1): the status code says which kind it is.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{status}: {detail}")]
pub struct Problem {
    status: StatusCode,
    detail: String,
    members: Map<String, Value>,
    retry_after: Option<Duration>,
    pub(crate) refusal: Option<Refusal>,
}

/// What is sent, for descriptions of an interface; further members depend on the problem.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "only its schema is of use: documents are put together from members")]
pub(crate) struct ProblemDocument {
    /// Always `about:blank`: the status says which kind it is.
    r#type: String,
    /// The status in words.
    title: String,
    /// The HTTP status code.
    status: u16,
    /// What is wrong, and what to do.
    detail: String,
}

impl Problem {
    /// A problem with this status; `detail` tells the user what is wrong and what to do.
    #[must_use]
    pub fn new(status: StatusCode, detail: impl Into<String>) -> Self {
        Self { status, detail: detail.into(), members: Map::new(), retry_after: None, refusal: None }
    }

    /// 404: `what` does not exist.
    #[must_use]
    pub fn not_found(what: &str) -> Self {
        Self::new(StatusCode::NOT_FOUND, format!("there is no {what}"))
    }

    /// 500: something of ours failed.
    #[must_use]
    pub fn internal(reason: &dyn std::fmt::Display) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, reason.to_string())
    }

    /// 503 with `Retry-After`: something is missing now that may be there later.
    #[must_use]
    pub fn unavailable(detail: impl Into<String>, retry_after: Duration) -> Self {
        let mut problem = Self::new(StatusCode::SERVICE_UNAVAILABLE, detail);
        problem.retry_after = Some(retry_after);
        problem
    }

    /// 400: a query parameter has a value that is not allowed, or is not known at all.
    #[must_use]
    pub fn parameter(name: &str, value: &str, allowed: &str) -> Self {
        Self::new(StatusCode::BAD_REQUEST, format!("parameter {name:?} is {value:?}; allowed is {allowed}"))
            .with("parameter", name)
            .with("value", value)
            .with("allowed", allowed)
    }

    /// Adds an extension member (RFC 9457 section 3.2).
    #[must_use]
    pub fn with(mut self, member: &str, value: impl Into<Value>) -> Self {
        self.members.insert(member.to_owned(), value.into());
        self
    }

    /// Says which counter goes up when this is sent.
    pub(crate) const fn because(mut self, refusal: Refusal) -> Self {
        self.refusal = Some(refusal);
        self
    }

    /// The status code.
    #[must_use]
    pub const fn status(&self) -> StatusCode {
        self.status
    }

    /// The document that is sent.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let mut document = self.members.clone();
        document.insert("type".to_owned(), json!("about:blank"));
        document.insert("title".to_owned(), json!(self.status.canonical_reason().unwrap_or("Problem")));
        document.insert("status".to_owned(), json!(self.status.as_u16()));
        document.insert("detail".to_owned(), json!(self.detail));
        Value::Object(document)
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response<Body> {
        let mut response = Response::new(Body::from(self.to_json().to_string()));
        *response.status_mut() = self.status;
        response.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(PROBLEM_JSON));
        if let Some(after) = self.retry_after {
            response.headers_mut().insert(RETRY_AFTER, HeaderValue::from(after.as_secs().max(1)));
        }
        if let Some(refusal) = self.refusal {
            // Counted where the answer leaves, so that no route needs to know the counters.
            response.extensions_mut().insert(refusal);
        }
        response
    }
}

/// Turns an error answer that some layer below made without a document into a problem.
#[must_use]
pub(crate) fn normalised(response: Response<Body>) -> Response<Body> {
    let status = response.status();
    let kind = response.headers().get(CONTENT_TYPE);
    let is_document = kind.is_some_and(|kind| kind == PROBLEM_JSON || kind == "application/json");
    if is_document || !(status.is_client_error() || status.is_server_error()) {
        return response;
    }
    let (parts, _) = response.into_parts();
    let mut problem = Problem::new(status, default_detail(status)).into_response();
    if let Some(allow) = parts.headers.get(ALLOW) {
        problem.headers_mut().insert(ALLOW, allow.clone());
    }
    problem
}

pub(crate) fn default_detail(status: StatusCode) -> &'static str {
    match status {
        StatusCode::BAD_REQUEST => "the request is not valid HTTP/1.1 or its content does not parse",
        StatusCode::NOT_FOUND => "there is nothing at this address",
        StatusCode::METHOD_NOT_ALLOWED => "this address does not take this method; see the Allow header",
        StatusCode::URI_TOO_LONG => "the address is too long; shorten the query",
        StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE => "the request's header is too large",
        StatusCode::UNSUPPORTED_MEDIA_TYPE => "send application/json",
        StatusCode::UNPROCESSABLE_ENTITY => "the content parses but its fields are not what is expected",
        _ => "the request could not be answered",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_problem_names_parameter_value_and_allowed() {
        let document = Problem::parameter("width", "1e9", "16..=3840").to_json();
        assert_eq!(document["status"], 400);
        assert_eq!(document["parameter"], "width");
        assert_eq!(document["value"], "1e9");
        assert_eq!(document["allowed"], "16..=3840");
    }

    #[test]
    fn unavailable_says_when_to_try_again() {
        let response = Problem::unavailable("no picture yet", Duration::from_secs(2)).into_response();
        assert_eq!(response.status(), StatusCode::SERVICE_UNAVAILABLE);
        assert_eq!(response.headers()[RETRY_AFTER], "2");
        assert_eq!(response.headers()[CONTENT_TYPE], PROBLEM_JSON);
    }

    #[test]
    fn a_bare_error_becomes_a_problem_and_keeps_allow() {
        let bare = Response::builder().status(405).header("allow", "GET").body(Body::empty()).unwrap();
        let response = normalised(bare);
        assert_eq!(response.headers()[CONTENT_TYPE], PROBLEM_JSON);
        assert_eq!(response.headers()["allow"], "GET");
    }
}
