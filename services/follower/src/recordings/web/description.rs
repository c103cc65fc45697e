//! What is said of the recordings' routes.

use std::ops::RangeInclusive;

use http_face::{Operation, PictureRequest, integer};
use serde_json::json;

use crate::pictures_out::LAYERS;
use crate::recordings::landmarks::RecordedLandmarks;
use crate::recordings::listing::Recordings;
use crate::recordings::registrations::Registrations;

use super::answers::FrameEntry;

/// Entries on one page.
pub(super) const PAGE: RangeInclusive<u32> = 1..=1000;
/// Entries on one page unless asked otherwise.
pub(super) const DEFAULT_PAGE: u32 = 100;
/// Places in a recording.
pub(super) const QUERY_PLACES: RangeInclusive<u64> = 0..=u64::MAX >> 1;

pub(super) fn list() -> Operation {
    Operation::get("Recordings, newest first")
        .query("limit", "At most so many", integer(&PAGE))
        .query("after", "Go on behind this one, from `next`", json!({ "type": "string", "pattern": NAME }))
        .gives::<Recordings>()
}

/// As the recorder names its files.
const NAME: &str = "^[a-z0-9][a-z0-9_-]{0,62}-[0-9]{8}T[0-9]{6}Z-[0-9]{4,18}\\.mcap$";

fn named(operation: Operation) -> Operation {
    operation
        .path("name", "Its name when it is finished", json!({ "type": "string", "pattern": NAME }))
        .problem(404, "There is no such recording")
}

pub(super) fn download() -> Operation {
    named(Operation::get("The file, whole or in part (Range, If-Range, If-None-Match)"))
        .binary("application/octet-stream")
        .partial("application/octet-stream")
        .empty(304)
        .problem(416, "The part lies behind the end")
}

pub(super) fn remove() -> Operation {
    named(Operation::delete("Deletes it")).empty(204).problem(409, "It is still being written")
}

fn of_camera(operation: Operation) -> Operation {
    named(operation)
        .query(
            "camera",
            "Whose pictures; may be left out where there is one camera",
            json!({ "type": "string" }),
        )
        .problem(422, "The file is damaged")
}

pub(super) fn frame() -> Operation {
    let file = json!({ "type": "string", "pattern": "^[0-9]{1,9}\\.(jpg|png|json)$" });
    let frame = of_camera(Operation::get(
        "Picture n of a camera as n.jpg or n.png, and what was seen in it live as n.json",
    ))
    .path("frame", "The picture's place, counted from 0, and what is wanted of it", file)
    .binary("image/jpeg")
    .binary("image/png")
    .gives::<FrameEntry>();
    PictureRequest::described(frame, LAYERS).with_quality()
}

pub(super) fn landmarks() -> Operation {
    named(Operation::get("The landmarks that it was made with, each by its digest"))
        .gives::<RecordedLandmarks>()
        .problem(422, "The file is damaged")
}

pub(super) fn registrations() -> Operation {
    of_camera(Operation::get("What was seen live, in the order of the recording"))
        .query("limit", "At most so many", integer(&PAGE))
        .query("after", "Go on from here, from `next`", integer(&QUERY_PLACES))
        .gives::<Registrations>()
}
