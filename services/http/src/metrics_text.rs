//! `/metrics` in the Prometheus text format.

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};

/// The answer to a scrape; `text` is in the Prometheus text exposition format 0.0.4.
#[must_use]
pub fn metrics_text(text: String) -> Response {
    ([(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], text).into_response()
}
