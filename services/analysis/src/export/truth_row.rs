//! One row of a simulator's truth: one frame, one object.

use serde::Serialize;
use waymark_proto::v1;

use crate::row::FrameKey;

/// The columns, in this order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TruthRow<'a> {
    /// The input as it was given.
    pub input: &'a str,
    /// Counts from 1 within its input and camera.
    pub frame: Option<u64>,
    /// Capture time, ns since the Unix epoch.
    pub captured_at_ns: i64,
    /// The camera's id.
    pub camera: Option<&'a str>,
    /// The object's name in the scene; a landmark has the name of its object, or what it begins with.
    pub object: &'a str,
    /// Centre of the visible silhouette, frame pixels, corner origin.
    pub x_px: f64,
    /// See `x_px`.
    pub y_px: f64,
    /// Area of the visible silhouette.
    pub area_px2: f64,
    /// Part of the object that is visible, 0..1.
    pub visible: f64,
}

/// The columns of [`TruthRow`].
pub(super) const TRUTH_COLUMNS: [&str; 9] =
    ["input", "frame", "captured_at_ns", "camera", "object", "x_px", "y_px", "area_px2", "visible"];

/// The rows of one frame.
pub fn truth_rows<'a>(key: FrameKey<'a>, truth: &'a v1::Truth) -> impl Iterator<Item = TruthRow<'a>> {
    truth.objects.iter().map(move |object| TruthRow {
        input: key.input,
        frame: key.frame,
        captured_at_ns: truth.captured_at_ns,
        camera: key.camera,
        object: &object.object,
        x_px: object.x_px,
        y_px: object.y_px,
        area_px2: object.area_px2,
        visible: object.visible,
    })
}
