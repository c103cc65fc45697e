//! A picture and what was seen in it, as the two parts of one answer (RFC 7578, which `Response.formData()` of the Fetch
//! standard reads).

use crate::picture_request::Format;
use axum::body::Body;
use axum::http::HeaderValue;
use axum::http::header::CONTENT_TYPE;
use axum::response::Response;
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;

/// Parts `seen`, if there is something to tell, and `picture`.
pub(crate) fn told_picture(format: Format, picture: &[u8], told: Option<&str>) -> Response {
    let boundary = boundary();
    let (kind, ending) = (format.content_type(), format.ending());
    let mut body = Vec::with_capacity(picture.len() + told.map_or(0, str::len) + 512);
    if let Some(told) = told {
        let head = format!(
            "--{boundary}\r\ncontent-disposition: form-data; name=\"seen\"\r\n\
             content-type: application/json\r\n\r\n{told}\r\n"
        );
        body.extend_from_slice(head.as_bytes());
    }
    let head = format!(
        "--{boundary}\r\ncontent-disposition: form-data; name=\"picture\"; filename=\"frame.{ending}\"\r\n\
         content-type: {kind}\r\n\r\n"
    );
    body.extend_from_slice(head.as_bytes());
    body.extend_from_slice(picture);
    body.extend_from_slice(format!("\r\n--{boundary}--\r\n").as_bytes());
    let mut response = Response::new(Body::from(body));
    if let Ok(kind) = HeaderValue::try_from(format!("multipart/form-data; boundary={boundary}")) {
        response.headers_mut().insert(CONTENT_TYPE, kind);
    }
    response
}

/// What a picture cannot hold on purpose: nobody can tell beforehand what the standard library seeds its hashes with.
fn boundary() -> String {
    let [first, second] = [0, 1].map(|part: u8| RandomState::new().hash_one(part));
    format!("waymark-{first:016x}{second:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::to_bytes;

    #[tokio::test]
    async fn both_parts_are_whole_and_every_answer_has_a_boundary_of_its_own() {
        let picture = b"\xff\xd8\r\n--waymark-\r\n\xff\xd9";
        let mut boundaries = Vec::new();
        for told in [Some("{\"sequence\":7}"), None] {
            let answer = told_picture(Format::Jpeg, picture, told);
            let kind = answer.headers()[CONTENT_TYPE].to_str().unwrap().to_owned();
            let boundary = kind.strip_prefix("multipart/form-data; boundary=").unwrap().to_owned();
            let body = to_bytes(answer.into_body(), 1 << 20).await.unwrap();
            assert!(body.ends_with(format!("\r\n--{boundary}--\r\n").as_bytes()));
            assert!(body.windows(picture.len()).any(|part| part == picture));
            let text = String::from_utf8_lossy(&body);
            assert_eq!(text.matches(&boundary).count(), if told.is_some() { 3 } else { 2 });
            assert_eq!(text.contains("\r\n\r\n{\"sequence\":7}\r\n"), told.is_some());
            boundaries.push(boundary);
        }
        assert_ne!(boundaries[0], boundaries[1]);
    }
}
