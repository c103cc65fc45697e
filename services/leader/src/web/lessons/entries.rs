//! What is said of a picture to learn from, and of what was learned from it.

use schemars::JsonSchema;
use serde::Serialize;
use vision::RectPx;
use vision::outcome::NearestMatch;
use waymark_proto::documents::LandmarkDocument;

use crate::lessons::{Learned, Lesson};

/// A picture that is kept to learn from.
#[derive(Serialize, JsonSchema)]
pub(super) struct LessonEntry {
    /// Names it in the addresses of what is learned from it.
    lesson: u64,
    /// The camera's id.
    camera: String,
    /// The frame's number in its stream.
    sequence: u64,
    /// When it was captured, ns since the Unix epoch.
    captured_at_ns: i64,
    /// Columns.
    width_px: u32,
    /// Rows.
    height_px: u32,
}

/// What was learned from a box.
#[derive(Serialize, JsonSchema)]
pub(super) struct LearnedEntry {
    /// The landmark; publish it with PUT.
    landmark: LandmarkDocument,
    /// How many tolerances everything else in the picture is off: above 1 nothing else matches, and the more the
    /// better. Null where there is nothing else.
    separation: Option<f32>,
    /// Where in the rest of the picture it comes nearest.
    nearest: Option<PlaceEntry>,
    /// How many tolerances the object itself is off at its best place; null where it is smaller than the window.
    object: Option<f32>,
    /// What registration finds in this picture; null where it finds nothing.
    seen: Option<SeenEntry>,
}

/// A place in the picture.
#[derive(Serialize, JsonSchema)]
struct PlaceEntry {
    /// Frame pixels.
    x_px: f32,
    /// Frame pixels.
    y_px: f32,
}

/// What registration finds.
#[derive(Serialize, JsonSchema)]
struct SeenEntry {
    /// Centre, frame pixels.
    x_px: f32,
    /// Centre, frame pixels.
    y_px: f32,
    /// Area, frame pixels².
    area_px2: f32,
    /// Belief, 0..1.
    score: f32,
    /// Whether the centre lies in the box.
    is_in_box: bool,
}

impl From<&Lesson> for LessonEntry {
    fn from(lesson: &Lesson) -> Self {
        Self {
            lesson: lesson.number,
            camera: lesson.camera.clone(),
            sequence: lesson.sequence,
            captured_at_ns: lesson.captured_at_ns,
            width_px: lesson.frame.width(),
            height_px: lesson.frame.height(),
        }
    }
}

impl LearnedEntry {
    /// What was learned from `region`.
    pub(super) fn of(learned: &Learned, region: RectPx) -> Self {
        let place = |nearest: NearestMatch| PlaceEntry { x_px: nearest.at.x, y_px: nearest.at.y };
        let contains = |x: f32, y: f32| {
            let across = region.x as f32..=(region.x + region.width) as f32;
            let down = region.y as f32..=(region.y + region.height) as f32;
            across.contains(&x) && down.contains(&y)
        };
        Self {
            landmark: LandmarkDocument::from(&learned.landmark),
            separation: Some(learned.separation.excess()).filter(|excess| excess.is_finite()),
            nearest: learned.separation.outside.map(place),
            object: learned.separation.inside.map(|inside| inside.excess),
            seen: learned.seen.as_ref().map(|seen| SeenEntry {
                x_px: seen.centroid.x,
                y_px: seen.centroid.y,
                area_px2: seen.area_px2,
                score: seen.score,
                is_in_box: contains(seen.centroid.x, seen.centroid.y),
            }),
        }
    }
}
