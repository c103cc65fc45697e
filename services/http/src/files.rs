//! Files as answers: whole or in part (RFC 9110 sections 13 and 14), read as the client takes them.

use crate::conditional::is_known;
use crate::problem::Problem;
use axum::body::Body;
use axum::http::header::{
    ACCEPT_RANGES, CACHE_CONTROL, CONTENT_DISPOSITION, CONTENT_LENGTH, CONTENT_RANGE, CONTENT_TYPE, ETAG,
    IF_RANGE, RANGE,
};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use std::io::SeekFrom;
use std::ops::Range;
use tokio::fs::File;
use tokio::io::{AsyncReadExt, AsyncSeekExt};
use tokio_util::io::ReaderStream;

/// Read from the file at a time.
const PIECE_BYTES: usize = 64 << 10;

/// A file that is open, and what its client is told of it.
#[derive(Debug)]
pub struct ServedFile {
    /// The file.
    pub file: File,
    /// Bytes of it that are served; it may grow meanwhile.
    pub length: u64,
    /// Its entity tag, with quotes; another content has another one.
    pub tag: String,
    /// Its media type.
    pub media_type: &'static str,
    /// What a client should call it; plain ASCII without quotes.
    pub name: String,
}

/// The file, the part of it that `request` asks for, or nothing but headers when the client has it already.
///
/// # Errors
/// 500 when the file cannot be read.
pub async fn serve_file(request: &HeaderMap, served: ServedFile) -> Result<Response, Problem> {
    if is_known(request, &served.tag) {
        return Ok(told(StatusCode::NOT_MODIFIED.into_response(), &served));
    }
    let asked = asked(request, &served);
    let part = match &asked {
        Asked::Whole => 0..served.length,
        Asked::Part(part) => part.clone(),
        Asked::Beyond => return Ok(beyond(&served)),
    };
    let mut response = told(Response::new(Body::empty()), &served);
    let headers = response.headers_mut();
    headers.insert(CONTENT_LENGTH, HeaderValue::from(part.end - part.start));
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(served.media_type));
    insert(headers, CONTENT_DISPOSITION, &format!("attachment; filename=\"{}\"", served.name));
    if let Asked::Part(part) = asked {
        let range = format!("bytes {}-{}/{}", part.start, part.end - 1, served.length);
        insert(headers, CONTENT_RANGE, &range);
        *response.status_mut() = StatusCode::PARTIAL_CONTENT;
    }
    *response.body_mut() = body(served.file, part).await?;
    Ok(response)
}

fn told(mut response: Response, served: &ServedFile) -> Response {
    let headers = response.headers_mut();
    insert(headers, ETAG, &served.tag);
    headers.insert(ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    response
}

fn insert(headers: &mut HeaderMap, name: HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        headers.insert(name, value);
    }
}

/// 416: the part lies behind the end.
fn beyond(served: &ServedFile) -> Response {
    let detail = format!("the file has {} bytes; the range asked for begins behind them", served.length);
    let problem = Problem::new(StatusCode::RANGE_NOT_SATISFIABLE, detail).with("length", served.length);
    let mut response = problem.into_response();
    insert(response.headers_mut(), CONTENT_RANGE, &format!("bytes */{}", served.length));
    response
}

async fn body(mut file: File, part: Range<u64>) -> Result<Body, Problem> {
    file.seek(SeekFrom::Start(part.start)).await.map_err(|error| {
        Problem::new(StatusCode::INTERNAL_SERVER_ERROR, format!("the file cannot be read: {error}"))
    })?;
    Ok(Body::from_stream(ReaderStream::with_capacity(file.take(part.end - part.start), PIECE_BYTES)))
}

/// What a request wants of a file.
#[derive(Debug, PartialEq, Eq)]
enum Asked {
    Whole,
    Part(Range<u64>),
    Beyond,
}

/// Several ranges at once, and what is no range of bytes, are answered with the whole, as a server may.
fn asked(request: &HeaderMap, served: &ServedFile) -> Asked {
    // A client that has a part of another version wants this one whole (RFC 9110 section 13.1.5).
    if request.get(IF_RANGE).is_some_and(|tag| *tag != served.tag) {
        return Asked::Whole;
    }
    let range = request.get(RANGE).and_then(|range| range.to_str().ok());
    let spec =
        range.and_then(|range| range.split_once('=')).filter(|(unit, _)| unit.eq_ignore_ascii_case("bytes"));
    spec.and_then(|(_, spec)| part(spec.trim(), served.length)).unwrap_or(Asked::Whole)
}

/// `first-last`, `first-` or `-count`; `None` for anything else.
fn part(spec: &str, length: u64) -> Option<Asked> {
    let (first, last) = spec.split_once('-')?;
    let number =
        |text: &str| text.bytes().all(|b| b.is_ascii_digit()).then(|| text.parse::<u64>().ok()).flatten();
    let range = match (first.is_empty(), last.is_empty()) {
        (true, true) => return None,
        (true, false) => length.saturating_sub(number(last)?)..length,
        (false, true) => number(first)?..length,
        (false, false) => {
            let (first, last) = (number(first)?, number(last)?);
            if last < first {
                return None;
            }
            first..last.saturating_add(1).min(length)
        }
    };
    Some(if range.start < range.end { Asked::Part(range) } else { Asked::Beyond })
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::to_bytes;
    use axum::http::header::IF_NONE_MATCH;

    async fn answer(headers: &[(HeaderName, &'static str)]) -> (u16, Option<String>, String) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        std::fs::write(&path, "0123456789").unwrap();
        let file = File::open(&path).await.unwrap();
        let (tag, name) = ("\"a1\"".to_owned(), "file".to_owned());
        let served = ServedFile { file, length: 10, tag, media_type: "text/plain", name };
        let request =
            headers.iter().map(|(name, value)| (name.clone(), HeaderValue::from_static(value))).collect();
        let response = serve_file(&request, served).await.unwrap();
        let range = response.headers().get(CONTENT_RANGE).map(|range| range.to_str().unwrap().to_owned());
        let status = response.status().as_u16();
        let body = to_bytes(response.into_body(), 1000).await.unwrap();
        (status, range, String::from_utf8_lossy(&body).into_owned())
    }

    async fn part_of(range: &'static str) -> (u16, Option<String>, String) {
        answer(&[(RANGE, range)]).await
    }

    fn partial(range: &str, body: &str) -> (u16, Option<String>, String) {
        (206, Some(range.to_owned()), body.to_owned())
    }

    #[tokio::test]
    async fn parts_are_those_of_the_standard() {
        assert_eq!(part_of("bytes=2-4").await, partial("bytes 2-4/10", "234"));
        assert_eq!(part_of("bytes=0-99").await, partial("bytes 0-9/10", "0123456789"));
        assert_eq!(part_of("bytes=7-").await, partial("bytes 7-9/10", "789"));
        assert_eq!(part_of("Bytes=-3").await, partial("bytes 7-9/10", "789"));
        assert_eq!(part_of("bytes=-99").await, partial("bytes 0-9/10", "0123456789"));
        for beyond in ["bytes=10-", "bytes=99-100", "bytes=-0"] {
            let (status, range, _) = part_of(beyond).await;
            assert_eq!((status, range.as_deref()), (416, Some("bytes */10")), "{beyond}");
        }
    }

    #[tokio::test]
    async fn what_is_no_single_range_is_answered_whole() {
        for range in ["bytes=1-2,4-5", "lines=1-2", "bytes=4-2", "bytes=-", "bytes=a-b", "bytes=+1-2", "2-4"]
        {
            assert_eq!(part_of(range).await, (200, None, "0123456789".to_owned()), "{range}");
        }
    }

    #[tokio::test]
    async fn a_known_file_is_not_sent_again_and_parts_of_two_versions_are_never_mixed() {
        assert_eq!(answer(&[(IF_NONE_MATCH, "\"a1\"")]).await.0, 304);
        assert_eq!(answer(&[(RANGE, "bytes=2-4"), (IF_RANGE, "\"a1\"")]).await.0, 206);
        assert_eq!(answer(&[(RANGE, "bytes=2-4"), (IF_RANGE, "\"b2\"")]).await.0, 200);
    }
}
