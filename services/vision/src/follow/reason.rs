//! Why an object that is followed was not found.

use super::Scene;
use super::state::Track;
use crate::adaptive::Likeness;
use crate::geometry::PointPx;
use crate::outcome::{Gate, Miss, Prediction};

/// An object that shows less than this part of itself is covered by something.
const COVERED: f32 = 0.5;
/// Before so many sightings nothing is known that could be covered.
const KNOWN_AFTER: u32 = 3;

/// The reason for a miss, from the place where the object should be. `nearest` is the nearest candidate of the frame
/// that could not be it.
pub(super) fn of_miss(
    scene: &Scene<'_>,
    track: &Track,
    likeness: &Likeness<'_>,
    prediction: &Prediction,
    gate: &Gate,
    nearest: Option<PointPx>,
) -> Miss {
    if !lies_inside(scene, prediction) || gate.bounds(scene.frame.size()).is_none() {
        return Miss::OutsideFrame;
    }
    if let Some(nearest) = nearest {
        return Miss::OutsideGate { innovation_px: prediction.centroid.distance_px(nearest) };
    }
    let visible = visible_part(scene, likeness, prediction);
    if track.sightings >= KNOWN_AFTER && visible < COVERED {
        Miss::Occluded { visible }
    } else {
        Miss::NoColour { best: None }
    }
}

fn lies_inside(scene: &Scene<'_>, prediction: &Prediction) -> bool {
    let PointPx { x, y } = prediction.centroid;
    x >= 0.0 && y >= 0.0 && x <= scene.frame.width() as f32 && y <= scene.frame.height() as f32
}

/// The part of the place where the object should be that still shows its colours, 0..1.
fn visible_part(scene: &Scene<'_>, likeness: &Likeness<'_>, prediction: &Prediction) -> f32 {
    let reach_px = (0.5 * prediction.area_px2.sqrt()).max(1.0);
    let place = Gate { centre: prediction.centroid, radius_x_px: reach_px, radius_y_px: reach_px };
    let Some(bounds) = place.bounds(scene.frame.size()) else { return 0.0 };
    let like = (bounds.y..bounds.y + bounds.height)
        .flat_map(|y| (bounds.x..bounds.x + bounds.width).map(move |x| (x, y)))
        .filter(|&(x, y)| likeness.matches(scene.frame.pixel(x, y)))
        .count();
    (like as f32 / (bounds.width * bounds.height) as f32).min(1.0)
}
