//! Answers that are only sent when the client does not have them already (RFC 9110 section 13).

use axum::body::{Body, Bytes};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, ETAG, IF_NONE_MATCH};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use sha2::{Digest, Sha256};

/// The entity tag of a content: the first 128 bits of its SHA-256, in hexadecimal and quotes.
#[must_use]
pub fn entity_tag(content: &[u8]) -> String {
    tag_from_digest(&Sha256::digest(content))
}

pub(crate) fn tag_from_digest(digest: &[u8]) -> String {
    let hex: String = digest.iter().take(16).map(|byte| format!("{byte:02x}")).collect();
    format!("\"{hex}\"")
}

/// 304 when `request` names this entity tag, else 200 with the content; either way with `ETag` and `no-cache`.
#[must_use]
pub fn conditional(request: &HeaderMap, tag: &str, content_type: &'static str, content: Bytes) -> Response {
    let mut response = if is_known(request, tag) {
        StatusCode::NOT_MODIFIED.into_response()
    } else {
        let mut whole = Response::new(Body::from(content));
        whole.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(content_type));
        whole
    };
    if let Ok(tag) = HeaderValue::from_str(tag) {
        response.headers_mut().insert(ETAG, tag);
    }
    response.headers_mut().insert(CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    response
}

/// Weak comparison, as If-None-Match asks (RFC 9110 section 13.1.2).
pub(crate) fn is_known(request: &HeaderMap, tag: &str) -> bool {
    request
        .get_all(IF_NONE_MATCH)
        .iter()
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','))
        .map(str::trim)
        .any(|known| known == "*" || known.trim_start_matches("W/") == tag)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(if_none_match: &'static str) -> u16 {
        let mut request = HeaderMap::new();
        request.insert(IF_NONE_MATCH, HeaderValue::from_static(if_none_match));
        conditional(&request, "\"ab\"", "text/plain", Bytes::from_static(b"x")).status().as_u16()
    }

    #[test]
    fn a_known_tag_is_not_sent_again() {
        assert_eq!(status("\"ab\""), 304);
        assert_eq!(status("\"x\", W/\"ab\""), 304);
        assert_eq!(status("*"), 304);
        assert_eq!(status("\"cd\""), 200);
    }

    #[test]
    fn tags_differ_with_content() {
        assert_eq!(entity_tag(b"a").len(), 34);
        assert_ne!(entity_tag(b"a"), entity_tag(b"b"));
    }
}
