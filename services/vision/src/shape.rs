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
    let Some(inertia) = Inertia::of(outline) else { return 0.0 };
    let count = outline.pixels().len() as f64;
    let radii = || outline.pixels().iter().map(|&pixel| inertia.radius(pixel));
    let mean = radii().sum::<f64>() / count;
    let spread = (radii().map(|radius| (radius - mean).powi(2)).sum::<f64>() / count).sqrt();
    1.0 - spread / mean / CIRCLE_TOLERANCE
}

/// Middle and covariance of the area inside an outline.
struct Inertia {
    middle: (f64, f64),
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Inertia {
    /// By Green's theorem on the closed line through the border pixels; `None` where it encloses nothing.
    fn of(outline: &Outline) -> Option<Self> {
        let (mut area, mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let origin = outline.pixels()[0];
        let from_origin = |pixel: (i32, i32)| (f64::from(pixel.0 - origin.0), f64::from(pixel.1 - origin.1));
        for at in 0..outline.pixels().len() {
            let ((ax, ay), (bx, by)) =
                (from_origin(outline.pixel_after(at, 0)), from_origin(outline.pixel_after(at, 1)));
            let cross = ax * by - ay * bx;
            area += cross / 2.0;
            x += (ax + bx) * cross / 6.0;
            y += (ay + by) * cross / 6.0;
            xx += (ax * ax + ax * bx + bx * bx) * cross / 12.0;
            yy += (ay * ay + ay * by + by * by) * cross / 12.0;
            xy += (ax * by + 2.0 * ax * ay + 2.0 * bx * by + bx * ay) * cross / 24.0;
        }
        let (x, y) = (x / area, y / area);
        let inertia = Self {
            middle: (x + f64::from(origin.0), y + f64::from(origin.1)),
            xx: xx / area - x * x,
            xy: xy / area - x * y,
            yy: yy / area - y * y,
        };
        (area.abs() > 0.0 && inertia.determinant() > 0.0).then_some(inertia)
    }

    fn determinant(&self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// Distance from the middle in standard deviations (Mahalanobis): the same for all points of an ellipse.
    fn radius(&self, pixel: (i32, i32)) -> f64 {
        let (x, y) = (f64::from(pixel.0) - self.middle.0, f64::from(pixel.1) - self.middle.1);
        ((self.yy * x * x - 2.0 * self.xy * x * y + self.xx * y * y) / self.determinant()).sqrt()
    }
}

fn vector(segment: &OutlineSegment) -> (f64, f64) {
    (segment.to.0 - segment.from.0, segment.to.1 - segment.from.1)
}

fn distance(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bitmask::BitMask;
    use crate::drawn::{ellipse, outline, polygon, rectangle};
    use crate::hough::Hough;

    fn fit_of(class: ShapeClass, mask: &BitMask) -> Option<f32> {
        let outline = outline(mask);
        fit(class, &outline, Hough::default().segments(&outline))
    }

    fn turns() -> impl Iterator<Item = f64> {
        (0..12).map(|turn| f64::from(turn) * 0.137)
    }

    /// Every figure at every turn fits its own class, and the others do not.
    fn check(class: ShapeClass, own: &dyn Fn(f64) -> BitMask, foreign: &dyn Fn(f64) -> BitMask) {
        for turn in turns() {
            let (own, foreign) = (fit_of(class, &own(turn)).unwrap(), fit_of(class, &foreign(turn)).unwrap());
            assert!(own >= 0.6, "{} at {turn}: own fit {own}", class.name());
            assert!(foreign < SMALLEST_FIT, "{} at {turn}: foreign fit {foreign}", class.name());
        }
    }

    #[test]
    fn a_block_has_perpendicular_sides_that_meet() {
        check(ShapeClass::Block, &|turn| rectangle(30.0, 24.0, turn), &|turn| polygon(3, 45.0, turn));
        check(ShapeClass::Block, &|turn| rectangle(12.0, 12.0, turn), &|_| ellipse(40.0, 37.0));
        check(ShapeClass::Block, &|turn| rectangle(60.0, 20.0, turn), &|turn| polygon(8, 60.0, turn));
    }

    #[test]
    fn a_rectangle_has_two_parallel_pairs() {
        check(ShapeClass::Rectangle, &|turn| rectangle(60.0, 20.0, turn), &|turn| polygon(3, 60.0, turn));
        check(ShapeClass::Rectangle, &|turn| rectangle(25.0, 25.0, turn), &|_| ellipse(40.0, 40.0));
    }

    #[test]
    fn an_octagon_has_eight_sides() {
        check(ShapeClass::Octagon, &|turn| polygon(8, 45.0, turn), &|turn| rectangle(40.0, 40.0, turn));
        check(ShapeClass::Octagon, &|turn| polygon(8, 80.0, turn), &|turn| polygon(3, 60.0, turn));
    }

    #[test]
    fn a_triangle_has_three_sides() {
        check(ShapeClass::Triangle, &|turn| polygon(3, 50.0, turn), &|turn| rectangle(40.0, 40.0, turn));
        check(ShapeClass::Triangle, &|turn| polygon(3, 30.0, turn), &|turn| polygon(8, 50.0, turn));
    }

    #[test]
    fn a_circle_may_be_foreshortened() {
        check(ShapeClass::Circle, &|_| ellipse(40.0, 40.0), &|turn| rectangle(40.0, 40.0, turn));
        check(ShapeClass::Circle, &|_| ellipse(50.0, 35.0), &|turn| polygon(3, 50.0, turn));
    }

    #[test]
    fn what_is_too_small_or_of_any_shape_has_no_fit() {
        assert_eq!(fit_of(ShapeClass::Block, &rectangle(2.0, 2.0, 0.0)), None);
        assert_eq!(fit_of(ShapeClass::Any, &rectangle(30.0, 30.0, 0.0)), None);
    }
}
