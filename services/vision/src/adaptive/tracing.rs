//! Outline, straight pieces and fit of the shape of an object that was found pixel by pixel.

use super::patch::Patch;
use crate::bitmask::{BitMask, Run};
use crate::geometry::{PointPx, Segment};
use crate::hough::{Hough, OutlineSegment};
use crate::landmark::ShapeClass;
use crate::measure::bwarea;
use crate::outcome::Sighting;
use crate::outline::Outline;
use crate::shape;

/// Outlines are thinned to at most about this many points.
const OUTLINE_POINTS: usize = 64;

/// Traces objects, with the memory to do so again and again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracer {
    mask: BitMask,
    runs: Vec<Run>,
    outline: Outline,
    hough: Hough,
}

impl Tracer {
    /// Traces the object on the doubled grid, on which outlines are judged by their length. What that says of it is
    /// written into `sighting`.
    pub(crate) fn trace(&mut self, object: &Patch<'_>, class: ShapeClass, sighting: &mut Sighting) {
        self.mask.reset(2 * object.rect.width, 2 * object.rect.height);
        for run in object.runs() {
            for y in [2 * run.y, 2 * run.y + 1] {
                self.mask.set_run(y, 2 * run.x_start, 2 * run.x_end);
            }
        }
        self.runs.clear();
        for y in 0..self.mask.height() {
            self.mask.append_runs(y, &mut self.runs);
        }
        sighting.outline.clear();
        sighting.segments.clear();
        (sighting.shape_score, sighting.mask_area_2x) = (None, 0.0);
        let Some(&first) = self.runs.first() else { return };
        self.outline.trace(&self.mask, first);
        let segments = self.hough.segments(&self.outline);
        sighting.outline.extend(thinned(object, &self.outline));
        sighting.segments.extend(segments.iter().map(|segment| in_frame(object, segment)));
        sighting.shape_score = shape::fit(class, &self.outline, segments);
        sighting.mask_area_2x = bwarea(&self.mask, &self.runs) as f32;
    }
}

fn thinned(object: &Patch<'_>, outline: &Outline) -> impl Iterator<Item = PointPx> {
    let step = outline.pixels().len().div_ceil(OUTLINE_POINTS).max(1);
    let point = |&(x, y): &(i32, i32)| frame_from_doubled(object, (f64::from(x), f64::from(y)));
    outline.pixels().iter().step_by(step).map(point)
}

fn in_frame(object: &Patch<'_>, segment: &OutlineSegment) -> Segment {
    Segment { from: frame_from_doubled(object, segment.from), to: frame_from_doubled(object, segment.to) }
}

/// The middle of a sample of the doubled grid, in frame pixels.
fn frame_from_doubled(object: &Patch<'_>, (x, y): (f64, f64)) -> PointPx {
    let (left, top) = (f64::from(object.rect.x), f64::from(object.rect.y));
    PointPx::new((left + (x + 0.5) / 2.0) as f32, (top + (y + 0.5) / 2.0) as f32)
}
