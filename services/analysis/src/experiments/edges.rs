//! Edges, Hough transform and its inverse in one go, as the thesis's Figures 2.5, 3.2 and 3.6 have them.

use vision::methods::{Intensity, Plane};
use vision::{Frame, PointPx, RectPx, Segment};

use super::ExperimentError;
use super::picture::grey;
use crate::sketch::line;
use crate::straight_lines::StraightLines;

/// A segment covers what lies within so many pixels.
const NEAR_PX: f32 = 2.0;
const RED: [u8; 3] = [255, 60, 40];

/// The strongest lines of a picture, and what they say about rectangles in it.
pub(super) struct Lines {
    pub(super) straight: StraightLines,
}

impl Lines {
    /// The `most` strongest lines.
    pub(super) fn of(frame: &Frame, most: usize) -> Self {
        Self { straight: StraightLines::of(frame, most) }
    }

    /// Their pieces.
    pub(super) fn segments(&self) -> &[Segment] {
        &self.straight.segments
    }

    /// Whether segments cover at least half of a thin rectangle.
    pub(super) fn cover(&self, side: RectPx) -> bool {
        let places =
            (side.y..side.y + side.height).flat_map(|y| (side.x..side.x + side.width).map(move |x| (x, y)));
        let places: Vec<PointPx> =
            places.map(|(x, y)| PointPx::new(x as f32 + 0.5, y as f32 + 0.5)).collect();
        let covered = places
            .iter()
            .filter(|place| self.segments().iter().any(|segment| distance_px(segment, **place) <= NEAR_PX));
        2 * covered.count() >= places.len()
    }

    /// The part of the segments' length that lies inside one of these rectangles.
    pub(super) fn share_inside(&self, rects: &[RectPx]) -> f64 {
        let inside = |point: PointPx| rects.iter().any(|rect| contains(rect, point));
        let (mut within, mut all) = (0.0, 0.0);
        for segment in self.segments() {
            let length = f64::from(segment.length_px());
            let steps = 16;
            let on = (0..=steps).filter(|step| inside(along(segment, *step as f32 / steps as f32))).count();
            all += length;
            within += length * on as f64 / f64::from(steps + 1);
        }
        if all > 0.0 { within / all } else { 0.0 }
    }

    /// The segments over the picture in grey.
    pub(super) fn drawn_over(&self, frame: &Frame) -> Result<Frame, ExperimentError> {
        let mut drawn = grey(&Plane::of(frame, Intensity::Luma), 0.0, 255.0)?;
        for segment in self.segments() {
            line(&mut drawn, segment.from, segment.to, 2, RED);
        }
        Ok(drawn)
    }
}

fn contains(rect: &RectPx, point: PointPx) -> bool {
    let within = |at: f32, start: u32, length: u32| at >= start as f32 && at <= (start + length) as f32;
    within(point.x, rect.x, rect.width) && within(point.y, rect.y, rect.height)
}

fn along(segment: &Segment, part: f32) -> PointPx {
    let Segment { from, to } = segment;
    PointPx::new(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y))
}

fn distance_px(segment: &Segment, point: PointPx) -> f32 {
    let Segment { from, to } = segment;
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let length2 = (dx * dx + dy * dy).max(f32::MIN_POSITIVE);
    let part = (((point.x - from.x) * dx + (point.y - from.y) * dy) / length2).clamp(0.0, 1.0);
    along(segment, part).distance_px(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_to_the_segment_and_not_to_its_line() {
        let segment = Segment { from: PointPx::new(0.0, 0.0), to: PointPx::new(10.0, 0.0) };
        assert_eq!(distance_px(&segment, PointPx::new(5.0, 3.0)), 3.0);
        assert_eq!(distance_px(&segment, PointPx::new(14.0, 3.0)), 5.0);
    }
}
