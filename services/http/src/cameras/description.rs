//! What is said of the pictures' routes.

use super::RATES_HZ;
use crate::api::{Operation, integer};
use crate::picture_request::PictureRequest;
use serde_json::json;

fn at_camera(summary: &'static str) -> Operation {
    Operation::get(summary)
        .path("camera", "The camera's id", json!({ "type": "string" }))
        .problem(404, "There is no such camera")
        .problem(503, "No picture has arrived yet, or the newest one is stale")
}

fn single(summary: &'static str) -> Operation {
    let sequence = json!({ "type": "integer", "minimum": 0, "maximum": u64::MAX });
    at_camera(summary).query("after", "Wait for a picture whose sequence is not this one", sequence)
}

/// A single JPEG.
pub(super) fn jpeg(summary: &'static str, layers: &'static [&'static str]) -> Operation {
    PictureRequest::described(single(summary).binary("image/jpeg"), layers).with_quality()
}

/// A single picture and what was seen in it.
pub(super) fn seen(layers: &'static [&'static str]) -> Operation {
    let formats = json!({ "type": "string", "enum": ["jpg", "png"] });
    let parts = json!({
        "type": "object",
        "properties": {
            "seen": { "type": "object", "description": "What was seen in it, as a recorded frame's registration" },
            "picture": { "type": "string", "format": "binary", "description": "The frame, bare unless layers are named" },
        },
        "required": ["picture"],
    });
    let operation = single("The newest frame and what was seen in it, in one answer")
        .query(
            "format",
            "The picture's: jpg, as the camera sent it where nothing else is asked, or png without loss",
            formats,
        )
        .answers("multipart/form-data", parts);
    PictureRequest::described(operation, layers).with_quality()
}

/// A single PNG.
pub(super) fn png(summary: &'static str, layers: &'static [&'static str]) -> Operation {
    PictureRequest::described(single(summary).binary("image/png"), layers)
}

/// Pictures without end.
pub(super) fn stream(layers: &'static [&'static str]) -> Operation {
    let yes_or_no = json!({ "type": "string", "enum": ["true", "false"] });
    let stream = at_camera("Every frame as it is registered, as Motion JPEG")
        .query("fps", "At most so many pictures per second", integer(&RATES_HZ))
        .query("overlay", "Whether to draw what was seen", yes_or_no)
        .binary("multipart/x-mixed-replace");
    PictureRequest::described(stream, layers).with_quality()
}
