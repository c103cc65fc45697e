//! What surrounds every route: admission, limits, security headers, problems, and the end at shutdown.

use crate::connection::Terms;
use crate::counters::Refusal;
use crate::guard::{is_change, judge};
use crate::policy::Access;
use crate::problem::{Problem, normalised};
use crate::viewers::Viewer;
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, HeaderName, REFERRER_POLICY, WWW_AUTHENTICATE,
    X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use bytes::BytesMut;
use futures_util::StreamExt;
use http_body_util::BodyExt;
use hyper::body::Body as _;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

/// Read and thrown away of a body that is too large, so that its sender gets to read the answer.
const MAX_DISCARDED_BYTES: usize = 16 << 20;

/// Nothing but our own files, no inline code, no frames around us.
const CONTENT_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Tells a client whether it may change things, so that the page can say so.
const ACCESS: HeaderName = HeaderName::from_static("x-waymark-access");

#[derive(Clone)]
pub(crate) struct Shell {
    terms: Terms,
    access: Access,
    own_name: Arc<str>,
}

impl Shell {
    pub(crate) fn new(terms: Terms, access: Access) -> Self {
        let own_name = rustix::system::uname().nodename().to_string_lossy().into();
        Self { terms, access, own_name }
    }
}

/// Puts the shell around a router.
pub(crate) fn wrap(router: Router, shell: Shell) -> Router {
    router.layer(from_fn_with_state(shell, pass))
}

async fn pass(State(shell): State<Shell>, request: Request, next: Next) -> Response {
    let viewer = Viewer::of(request.headers(), &shell.terms.policy);
    let mut response = match admit(&shell, request).await {
        Ok(request) => answer(&shell, request, next).await,
        Err(problem) => problem.into_response(),
    };
    if let Some(refusal) = response.extensions().get::<Refusal>() {
        shell.terms.counters.count(*refusal);
    }
    response = end_at_shutdown(normalised(response), &shell.terms.closing);
    if response.status() == StatusCode::UNAUTHORIZED {
        // RFC 6750 section 3
        response.headers_mut().insert(WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
    }
    response.headers_mut().insert(ACCESS, HeaderValue::from_static(shell.access.name()));
    if let Some(viewer) = viewer {
        viewer.admit(&mut response);
    }
    secure(response.headers_mut());
    response
}

async fn admit(shell: &Shell, request: Request) -> Result<Request, Problem> {
    let (mut parts, body) = request.into_parts();
    judge(&parts, &shell.terms.policy, shell.access, &shell.own_name)?;
    parts.extensions.insert(shell.access);
    parts.extensions.insert(Arc::clone(&shell.terms.counters));
    if !is_change(&parts.method) {
        return Ok(Request::from_parts(parts, Body::empty()));
    }
    let bytes = read_body(body, shell.terms.policy.max_body_bytes, shell.terms.policy.body_timeout).await?;
    Ok(Request::from_parts(parts, Body::from(bytes)))
}

async fn read_body(body: Body, limit: usize, patience: Duration) -> Result<Bytes, Problem> {
    match timeout(patience, collect(body, limit)).await {
        Ok(Ok(Some(bytes))) => Ok(bytes),
        Ok(Ok(None)) => {
            let detail = format!("the body is larger than the {limit} bytes allowed");
            let problem = Problem::new(StatusCode::PAYLOAD_TOO_LARGE, detail).with("max_bytes", limit);
            Err(problem.because(Refusal::Body))
        }
        Ok(Err(error)) => {
            let problem = Problem::new(StatusCode::BAD_REQUEST, format!("the body broke off: {error}"));
            Err(problem.because(Refusal::Body))
        }
        Err(_) => {
            let detail = format!("the body did not arrive within {} s", patience.as_secs());
            Err(Problem::new(StatusCode::REQUEST_TIMEOUT, detail).because(Refusal::SlowBody))
        }
    }
}

/// The whole body, or `None` when it is larger than `limit`.
async fn collect(mut body: Body, limit: usize) -> Result<Option<Bytes>, axum::Error> {
    let mut kept = BytesMut::new();
    let mut total = 0;
    while let Some(frame) = body.frame().await {
        let Ok(data) = frame?.into_data() else { continue };
        total += data.len();
        if total <= limit {
            kept.extend_from_slice(&data);
        } else if total > limit + MAX_DISCARDED_BYTES {
            break;
        }
    }
    Ok((total <= limit).then(|| kept.freeze()))
}

/// Lets the route answer; a read that is still waiting when the service closes is told so.
async fn answer(shell: &Shell, request: Request, next: Next) -> Response {
    if is_change(request.method()) {
        return next.run(request).await;
    }
    tokio::select! {
        response = next.run(request) => response,
        () = shell.terms.closing.cancelled() => {
            Problem::unavailable("the service is shutting down", Duration::from_secs(2)).into_response()
        }
    }
}

/// Ends a body of unknown length, which is a stream, when the service closes.
fn end_at_shutdown(response: Response, closing: &CancellationToken) -> Response {
    if response.body().size_hint().exact().is_some() {
        return response;
    }
    let closing = closing.clone().cancelled_owned();
    response.map(|body| Body::from_stream(body.into_data_stream().take_until(closing)))
}

fn secure(headers: &mut HeaderMap) {
    const RESOURCE_POLICY: HeaderName = HeaderName::from_static("cross-origin-resource-policy");
    const OPENER_POLICY: HeaderName = HeaderName::from_static("cross-origin-opener-policy");
    if headers.get(axum::http::header::CONTENT_TYPE).is_some() {
        headers.entry(CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    }
    let fixed = [
        (CONTENT_SECURITY_POLICY, CONTENT_POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (REFERRER_POLICY, "no-referrer"),
        (X_FRAME_OPTIONS, "DENY"),
        (OPENER_POLICY, "same-origin"),
        (RESOURCE_POLICY, "same-origin"),
    ];
    for (name, value) in fixed {
        // A route may be stricter or, for files that viewers elsewhere may open, looser.
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    }
}
