//! Shape without colour: the strongest straight pieces of the whole picture, and of them the longest two that are
//! perpendicular and meet (thesis 4.0.2). What the Hough transform tells alone.

use vision::{Frame, PointPx, Segment};

use crate::score::Claim;
use crate::straight_lines::StraightLines;

/// Strongest lines that are looked at.
const LINES: usize = 40;
/// Thesis 4.0.5.
const TOLERANCE_DEGREES: f32 = 9.0;
/// Two sides meet within so many pixels.
const CORNER_PX: f32 = 5.0;

/// It has no memory: each frame is new.
pub(super) struct LoneHough;

impl LoneHough {
    pub(super) fn look(&self, frame: &Frame) -> Option<Claim> {
        let pieces = StraightLines::of(frame, LINES).segments;
        let pairs = pieces
            .iter()
            .enumerate()
            .flat_map(|(at, one)| pieces[at + 1..].iter().map(move |other| (one, other)));
        let corners = pairs.filter(|(one, other)| is_corner(one, other));
        let shorter = |pair: &(&Segment, &Segment)| pair.0.length_px().min(pair.1.length_px());
        let (one, other) = corners.max_by(|a, b| shorter(a).total_cmp(&shorter(b)))?;
        // The two sides span a rectangle, whose middle is that between their far ends.
        let middle = |segment: &Segment| {
            PointPx::new((segment.from.x + segment.to.x) / 2.0, (segment.from.y + segment.to.y) / 2.0)
        };
        let corner = meeting(one, other)?;
        let (a, b) = (middle(one), middle(other));
        let centre = PointPx::new(a.x + b.x - corner.x, a.y + b.y - corner.y);
        Some(Claim { centre, area_px2: one.length_px() * other.length_px(), score: 1.0 })
    }
}

fn is_corner(one: &Segment, other: &Segment) -> bool {
    let between = (one.direction_rad() - other.direction_rad()).to_degrees().rem_euclid(180.0);
    (between - 90.0).abs() <= TOLERANCE_DEGREES && meeting(one, other).is_some()
}

/// The corner of two segments, where two of their ends meet.
fn meeting(one: &Segment, other: &Segment) -> Option<PointPx> {
    let ends = [one.from, one.to].into_iter().flat_map(|a| [other.from, other.to].map(|b| (a, b)));
    let (a, b) = ends.min_by(|x, y| x.0.distance_px(x.1).total_cmp(&y.0.distance_px(y.1)))?;
    (a.distance_px(b) <= CORNER_PX).then(|| PointPx::new((a.x + b.x) / 2.0, (a.y + b.y) / 2.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dark_square_is_found_by_two_of_its_sides() {
        let dark = |x: u32, y: u32| (40..70).contains(&x) && (30..60).contains(&y);
        let rgb = (0..100).flat_map(|y| (0..120).flat_map(move |x| [if dark(x, y) { 20 } else { 220 }; 3]));
        let frame = Frame::from_rgb(120, 100, rgb.collect()).unwrap();
        let claim = LoneHough.look(&frame).unwrap();
        assert!(claim.centre.distance_px(PointPx::new(55.0, 45.0)) < 4.0, "{claim:?}");
    }
}
