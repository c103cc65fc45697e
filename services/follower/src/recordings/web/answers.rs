//! A recorded frame as a picture and as a document.

use std::sync::Arc;

use axum::Json;
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use http_face::{Format, PictureRequest, Problem, picture_answer};
use schemars::JsonSchema;
use serde::Serialize;
use vision::{Frame, Landmark, Outcome};

use crate::pictures_out;
use crate::recordings::frame::RecordedFrame;
use crate::seen_frame::SeenFrame;

/// A recorded picture and what was said of it.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct FrameEntry {
    /// The picture's place in the recording.
    frame: usize,
    /// Pictures of this camera in the recording.
    frames: usize,
    /// Seconds from the recording's first picture of this camera, by arrival.
    at_s: f64,
    /// The frame's number in its stream.
    sequence: u64,
    /// When it was captured, ns since the Unix epoch.
    captured_at_ns: i64,
    /// What was seen in it; null where it was not registered.
    registration: Option<SeenFrame>,
}

/// The document of a frame; `times_ns` are those of all pictures of its camera.
pub(super) fn told(frame: &RecordedFrame, n: usize, times_ns: &[u64]) -> Response {
    let since_first_ns = |at: u64| i128::from(at) - i128::from(times_ns.first().copied().unwrap_or(at));
    let entry = FrameEntry {
        frame: n,
        frames: times_ns.len(),
        at_s: times_ns.get(n).map_or(0.0, |&at| since_first_ns(at) as f64 * 1e-9),
        sequence: frame.sequence,
        captured_at_ns: frame.captured_at.nanos,
        registration: frame.recorded.as_ref().map(|seen| SeenFrame::new(&seen.outcome, &seen.places)),
    };
    Json(entry).into_response()
}

/// The picture of a frame, drawn as live ones are.
pub(super) fn shown(
    frame: &RecordedFrame,
    pixels: Frame,
    request: &PictureRequest,
    landmarks: &[Arc<Landmark>],
) -> Result<Response, Problem> {
    let nothing_seen = Outcome::default();
    let outcome = frame.recorded.as_ref().map_or(&nothing_seen, |seen| &seen.outcome);
    let bytes = pictures_out::drawn(pixels, outcome, request, landmarks)
        .map_err(|reason| Problem::internal(&reason))?;
    Ok(picture(frame, request.format, bytes.into()))
}

/// The answer that holds it.
pub(super) fn picture(frame: &RecordedFrame, format: Format, bytes: Bytes) -> Response {
    picture_answer(frame.sequence, frame.captured_at.nanos, format, bytes)
}
