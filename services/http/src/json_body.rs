//! Bodies that are JSON documents.

use crate::problem::Problem;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, StatusCode};
use serde::de::DeserializeOwned;

/// The document in a body.
///
/// # Errors
/// 415 when it is not announced as JSON, 400 when it is none, 422 when it is another one than expected.
pub fn json_body<T: DeserializeOwned>(headers: &HeaderMap, body: &[u8]) -> Result<T, Problem> {
    let kind = headers.get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let essence = kind.split(';').next().unwrap_or_default().trim();
    if !essence.eq_ignore_ascii_case("application/json") {
        return Err(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "send application/json"));
    }
    serde_json::from_slice(body).map_err(|error| {
        let status = match error.classify() {
            serde_json::error::Category::Data => StatusCode::UNPROCESSABLE_ENTITY,
            _ => StatusCode::BAD_REQUEST,
        };
        Problem::new(status, format!("the body is not what is expected: {error}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn read(kind: &'static str, body: &str) -> Result<Vec<u32>, u16> {
        let headers = HeaderMap::from_iter([(CONTENT_TYPE, HeaderValue::from_static(kind))]);
        json_body(&headers, body.as_bytes()).map_err(|problem| problem.status().as_u16())
    }

    #[test]
    fn each_way_of_being_wrong_has_its_status() {
        assert_eq!(read("Application/JSON; charset=utf-8", "[1]"), Ok(vec![1]));
        assert_eq!(read("text/plain", "[1]"), Err(415));
        assert_eq!(read("application/json", "[1"), Err(400));
        assert_eq!(read("application/json", "[-1]"), Err(422));
    }
}
