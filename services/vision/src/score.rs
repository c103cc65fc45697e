//! How much a sighting deserves belief, and which of several comes first.

use crate::landmark::WindowPx;
use crate::outcome::{Prediction, Sighting};

/// Sightings with a smaller part of the best one's score are specks, not instances.
const SMALLEST_PART_OF_BEST: f32 = 0.4;

/// An object as large as this many windows earns half of the score that size can give.
const HALF_SCORE_WINDOWS: f32 = 4.0;

/// 0..1 for one sighting: by its size, by its shape, and by its agreement with the prediction where there is one.
///
/// The thesis takes the leftmost component, which is wrong in three frames of four of its own blue data; the larger one
/// is right far more often, since specks of the landmark's colour are everywhere and large areas of it are not.
#[must_use]
pub fn score(sighting: &Sighting, window: WindowPx, prediction: Option<&Prediction>) -> f32 {
    let window_px2 = f32::from(window.width) * f32::from(window.height) / 4.0;
    let size = sighting.area_px2 / (sighting.area_px2 + HALF_SCORE_WINDOWS * window_px2);
    let shape = sighting.shape_score.map_or(0.75, |fit| 0.5 + 0.5 * fit);
    size * shape * prediction.map_or(1.0, |prediction| agreement(sighting, prediction))
}

/// Sorts by score, best first, drops specks, and notes how distinct each one is.
pub fn rank(sightings: &mut Vec<Sighting>) {
    sightings.sort_by(|a, b| b.score.total_cmp(&a.score));
    let best = sightings.first().map_or(0.0, |sighting| sighting.score);
    let runner_up = sightings.get(1).map_or(0.0, |sighting| sighting.score);
    sightings.retain(|sighting| sighting.score >= SMALLEST_PART_OF_BEST * best);
    for (place, sighting) in sightings.iter_mut().enumerate() {
        let rival = if place == 0 { runner_up } else { best };
        sighting.distinctness = (1.0 - rival / sighting.score).clamp(0.0, 1.0);
    }
}

/// 1 at the predicted place and size, less with the distance in standard deviations and with the ratio of areas.
fn agreement(sighting: &Sighting, prediction: &Prediction) -> f32 {
    let [xx, xy, yy] = prediction.covariance_px2;
    let (dx, dy) = (sighting.centroid.x - prediction.centroid.x, sighting.centroid.y - prediction.centroid.y);
    let determinant = xx * yy - xy * xy;
    // Without a usable covariance the object's own extent takes its place.
    let squared_distance = if determinant > f32::EPSILON {
        (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / determinant
    } else {
        (dx * dx + dy * dy) / prediction.area_px2.max(1.0)
    };
    let ratio = sighting.area_px2 / prediction.area_px2;
    let size = if ratio.is_normal() { ratio.min(1.0 / ratio).max(0.0).sqrt() } else { 1.0 };
    size / (1.0 + squared_distance / 9.0)
}
