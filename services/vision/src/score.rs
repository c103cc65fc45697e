//! How much a sighting deserves belief, and which of several comes first.

use crate::doubled_grid::DoubledGrid;
use crate::geometry::PointPx;
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
    let samples = f64::from(window.width) * f64::from(window.height);
    let window_px2 = DoubledGrid::area_px2_from_samples(samples) as f32;
    let size = sighting.area_px2 / (sighting.area_px2 + HALF_SCORE_WINDOWS * window_px2);
    let shape = sighting.shape_score.map_or(0.75, |fit| 0.5 + 0.5 * fit);
    size * shape * prediction.map_or(1.0, |prediction| agreement(sighting, prediction))
}

/// Sorts by score, best first, drops specks and further pieces of objects already there, and notes how distinct each
/// sighting is. Hands `dropped` what it drops.
pub fn rank(sightings: &mut Vec<Sighting>, mut dropped: impl FnMut(Sighting)) {
    sort_by_score(sightings);
    let pieces = gather_pieces(sightings);
    sightings.drain(pieces..).for_each(&mut dropped);
    let best = sightings.first().map_or(0.0, |sighting| sighting.score);
    let runner_up = sightings.get(1).map_or(0.0, |sighting| sighting.score);
    let specks = sightings.partition_point(|sighting| sighting.score >= SMALLEST_PART_OF_BEST * best);
    sightings.drain(specks..).for_each(dropped);
    for (place, sighting) in sightings.iter_mut().enumerate() {
        let rival = if place == 0 { runner_up } else { best };
        sighting.distinctness = (1.0 - rival / sighting.score).clamp(0.0, 1.0);
    }
}

/// Best first, equals in their order; in place, where the standard library's stable sort asks for memory.
fn sort_by_score(sightings: &mut [Sighting]) {
    for at in 1..sightings.len() {
        let score = sightings[at].score;
        let place = sightings[..at].partition_point(|better| better.score.total_cmp(&score).is_ge());
        sightings[place..=at].rotate_right(1);
    }
}

/// Puts sightings that overlap a better one last, and says how many do not: two instances do not cover each other, but a
/// shaded or lettered object may well fall into several components.
fn gather_pieces(sightings: &mut [Sighting]) -> usize {
    let mut kept = 0;
    for at in 0..sightings.len() {
        let bounds = Bounds::of(&sightings[at].outline);
        if !sightings[..kept].iter().any(|better| Bounds::of(&better.outline).overlap(&bounds)) {
            sightings.swap(kept, at);
            kept += 1;
        }
    }
    kept
}

/// The bounding box of an outline.
struct Bounds {
    low: PointPx,
    high: PointPx,
}

impl Bounds {
    fn of(outline: &[PointPx]) -> Self {
        let nothing = Self {
            low: PointPx::new(f32::INFINITY, f32::INFINITY),
            high: PointPx::new(f32::NEG_INFINITY, f32::NEG_INFINITY),
        };
        outline.iter().fold(nothing, |bounds, point| Self {
            low: PointPx::new(bounds.low.x.min(point.x), bounds.low.y.min(point.y)),
            high: PointPx::new(bounds.high.x.max(point.x), bounds.high.y.max(point.y)),
        })
    }

    fn overlap(&self, other: &Self) -> bool {
        self.low.x < other.high.x
            && other.low.x < self.high.x
            && self.low.y < other.high.y
            && other.low.y < self.high.y
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

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(x: f32, side: f32) -> Sighting {
        let (low, high) = (x - side / 2.0, x + side / 2.0);
        let corners = [(low, low), (high, low), (high, high), (low, high)];
        let mut sighting = Sighting {
            centroid: PointPx::new(x, x),
            area_px2: side * side,
            outline: corners.map(|(x, y)| PointPx::new(x, y)).to_vec(),
            ..Sighting::default()
        };
        sighting.score = score(&sighting, WindowPx::square(12), None);
        sighting
    }

    #[test]
    fn the_larger_comes_first_and_pieces_and_specks_go() {
        let mut sightings = vec![seen(15.0, 8.0), seen(20.0, 30.0), seen(90.0, 25.0), seen(200.0, 1.0)];
        rank(&mut sightings, drop);
        let places: Vec<f32> = sightings.iter().map(|sighting| sighting.centroid.x).collect();
        assert_eq!(places, [20.0, 90.0]);
        assert!(sightings[0].distinctness > 0.0 && sightings[1].distinctness == 0.0);
    }

    #[test]
    fn one_alone_is_wholly_distinct() {
        let mut sightings = vec![seen(20.0, 30.0)];
        rank(&mut sightings, drop);
        assert_eq!(sightings[0].distinctness, 1.0);
    }

    #[test]
    fn a_prediction_outweighs_size() {
        let prediction = Prediction {
            centroid: PointPx::new(90.0, 90.0),
            area_px2: 400.0,
            covariance_px2: [4.0, 0.0, 4.0],
        };
        let window = WindowPx::square(12);
        let (near, far) = (seen(91.0, 20.0), seen(20.0, 60.0));
        assert!(score(&near, window, Some(&prediction)) > score(&far, window, Some(&prediction)));
        let vague = Prediction { covariance_px2: [0.0; 3], ..prediction };
        assert!(score(&near, window, Some(&vague)) > score(&far, window, Some(&vague)));
    }
}
