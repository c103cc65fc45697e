//! Steps 11 and 12 of thesis 4.0.3: how well an outline fits a landmark's shape class.
//!
//! The window erodes the object that it slides over, which shortens and shifts its sides but leaves their directions;
//! so polygons are judged by the directions of the segments found in the outline and by how much of the outline they
//! explain. Circles are judged by the distances of the outline from its ellipse of inertia.

use std::f64::consts::{PI, TAU};

use crate::hough::OutlineSegment;
use crate::landmark::ShapeClass;
use crate::outline::Outline;

/// An outline that fits worse is of another shape, for those who insist on the shape.
pub const SMALLEST_FIT: f32 = 0.5;

/// Thesis 4.0.5: "perpendicular within 9 degrees of tolerance".
const PERPENDICULAR_TOLERANCE_RAD: f64 = 9.0 * PI / 180.0;

/// How far the corner of two sides may lie from their ends: this many mask pixels and this part of the shorter side.
/// Without it ten random segments pass a bare test of angles 98 times in a hundred.
const CORNER_REACH: f64 = 4.0;
const CORNER_REACH_SHARE: f64 = 0.3;

/// Deviation, as a part of the mean radius, at which an outline is no circle at all.
const CIRCLE_TOLERANCE: f64 = 0.08;

/// The fit of `outline`, whose straight pieces are `segments` in clockwise order, to `class`: 0 (none) to 1 (all of
/// the outline). `None` where the class says nothing or the outline is too short to tell.
#[must_use]
pub fn fit(class: ShapeClass, outline: &Outline, segments: &[OutlineSegment]) -> Option<f32> {
    let enough = |border_pixels: usize| outline.pixels().len() >= border_pixels;
    let perimeter = outline.length();
    let score = match class {
        ShapeClass::Any => None,
        ShapeClass::Block => enough(24).then(|| perpendicular_share(segments, perimeter)),
        ShapeClass::Rectangle => enough(24).then(|| best_turn(&RECTANGLE, segments, perimeter)),
        ShapeClass::Octagon => enough(48).then(|| best_turn(&OCTAGON, segments, perimeter)),
        ShapeClass::Triangle => enough(24).then(|| best_turn(&TRIANGLE, segments, perimeter)),
        ShapeClass::Circle => enough(32).then(|| roundness(outline)),
    };
    score.map(|score| score.clamp(0.0, 1.0) as f32)
}

/// Whether a segment takes part in a perpendicular pair: another one stands on it within 9° and they meet near their
/// ends (step 12; what has no partner is thrown out).
#[must_use]
pub fn is_perpendicular_to_any(segment: &OutlineSegment, segments: &[OutlineSegment]) -> bool {
    segments.iter().any(|other| are_perpendicular(segment, other) && meet(segment, other))
}

/// The part of the outline that perpendicular pairs explain.
fn perpendicular_share(segments: &[OutlineSegment], perimeter: f64) -> f64 {
    let paired = segments.iter().filter(|segment| is_perpendicular_to_any(segment, segments));
    paired.map(OutlineSegment::length).sum::<f64>() / perimeter
}

fn are_perpendicular(a: &OutlineSegment, b: &OutlineSegment) -> bool {
    let between = (a.heading_rad() - b.heading_rad()).rem_euclid(PI);
    (between - PI / 2.0).abs() <= PERPENDICULAR_TOLERANCE_RAD
}

/// Whether the lines of `a` and `b` cross near an end of each.
fn meet(a: &OutlineSegment, b: &OutlineSegment) -> bool {
    let (da, db) = (vector(a), vector(b));
    let cross = da.0 * db.1 - da.1 * db.0;
    let between = (b.from.0 - a.from.0, b.from.1 - a.from.1);
    let along = (between.0 * db.1 - between.1 * db.0) / cross;
    let corner = (a.from.0 + along * da.0, a.from.1 + along * da.1);
    let reach = CORNER_REACH + CORNER_REACH_SHARE * a.length().min(b.length());
    [a, b].iter().all(|side| distance(corner, side.from).min(distance(corner, side.to)) <= reach)
}

/// A polygon as directions of travel around it.
struct Polygon {
    sides: usize,
    /// How far a side's direction may be off, for foreshortening.
    tolerance_rad: f64,
    /// A side's largest share of the perimeter; what is longer does not count.
    largest_share: f64,
    /// Whether sides count only as far as their opposites match them.
    opposites: Opposites,
}

enum Opposites {
    Equal,
    None,
}

const RECTANGLE: Polygon =
    Polygon { sides: 4, tolerance_rad: 14.0 * PI / 180.0, largest_share: 0.5, opposites: Opposites::Equal };
const OCTAGON: Polygon =
    Polygon { sides: 8, tolerance_rad: 13.0 * PI / 180.0, largest_share: 0.18, opposites: Opposites::Equal };
const TRIANGLE: Polygon =
    Polygon { sides: 3, tolerance_rad: 20.0 * PI / 180.0, largest_share: 0.45, opposites: Opposites::None };

/// The fit at the best turn of the polygon; turns by any segment's own direction are tried.
fn best_turn(polygon: &Polygon, segments: &[OutlineSegment], perimeter: f64) -> f64 {
    let turns = segments.iter().map(OutlineSegment::heading_rad);
    turns.map(|turn| fit_turned(polygon, turn, segments, perimeter)).fold(0.0, f64::max)
}

/// The part of the outline that sides at `turn`, `turn` + 360°/N … explain, less for every side that is missing.
fn fit_turned(polygon: &Polygon, turn: f64, segments: &[OutlineSegment], perimeter: f64) -> f64 {
    let mut shares = [0.0; 8];
    let step = TAU / polygon.sides as f64;
    for segment in segments {
        let place = (segment.heading_rad() - turn).rem_euclid(TAU) / step;
        let off_rad = (place - place.round()).abs() * step;
        if off_rad <= polygon.tolerance_rad {
            shares[place.round() as usize % polygon.sides] += segment.length() / perimeter;
        }
    }
    let shares = &mut shares[..polygon.sides];
    let present = shares.iter().filter(|&&share| share >= 0.25 / polygon.sides as f64).count();
    let counted = |side: usize| match polygon.opposites {
        Opposites::Equal => shares[side].min(1.5 * shares[(side + polygon.sides / 2) % polygon.sides]),
        Opposites::None => shares[side],
    };
    let explained: f64 = (0..polygon.sides).map(|side| counted(side).min(polygon.largest_share)).sum();
    explained * present as f64 / polygon.sides as f64
}

/// 1 for an ellipse, 0 where distances from the ellipse of inertia spread by [`CIRCLE_TOLERANCE`].
fn roundness(outline: &Outline) -> f64 {
    let count = outline.pixels().len() as f64;
    let points = || outline.pixels().iter().map(|&(x, y)| (f64::from(x), f64::from(y)));
    let mean = points().fold((0.0, 0.0), |mean, (x, y)| (mean.0 + x / count, mean.1 + y / count));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in points().map(|(x, y)| (x - mean.0, y - mean.1)) {
        (xx, xy, yy) = (xx + x * x / count, xy + x * y / count, yy + y * y / count);
    }
    let determinant = xx * yy - xy * xy;
    if determinant <= 0.0 {
        return 0.0;
    }
    // The Mahalanobis distance of every point of an ellipse from its middle is the same, √2.
    let radius = |(x, y): (f64, f64)| {
        let (x, y) = (x - mean.0, y - mean.1);
        ((yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant).sqrt()
    };
    let mean_radius = points().map(radius).sum::<f64>() / count;
    let spread = (points().map(|point| (radius(point) - mean_radius).powi(2)).sum::<f64>() / count).sqrt();
    1.0 - spread / mean_radius / CIRCLE_TOLERANCE
}

fn vector(segment: &OutlineSegment) -> (f64, f64) {
    (segment.to.0 - segment.from.0, segment.to.1 - segment.from.1)
}

fn distance(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}
