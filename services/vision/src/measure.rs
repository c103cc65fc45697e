//! Step 13 of thesis 4.0.3: centre, area and outline of a component, in frame pixels.
//!
//! A mask pixel is set where a whole window fits the landmark's colours, so the mask shows the object eroded by the
//! window. Growing the component back by the window gives the object: one window side minus one sample wider in each
//! direction. The centre needs no such correction.

use crate::bitmask::{BitMask, Run};
use crate::components::Component;
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::geometry::{PointPx, Segment};
use crate::hough::OutlineSegment;
use crate::outcome::Sighting;
use crate::outline::Outline;
use crate::statistics::WindowSums;

/// Border points nearer than this to the simplified outline are left out, in mask pixels.
const OUTLINE_TOLERANCE: f64 = 0.75;

/// One component with all that was found out about it.
#[derive(Clone, Copy)]
pub struct Evidence<'a> {
    /// The mask that it is part of.
    pub mask: &'a BitMask,
    /// The component.
    pub component: &'a Component,
    /// Its runs.
    pub runs: &'a [Run],
    /// Its outline.
    pub outline: &'a Outline,
    /// The straight pieces of the outline.
    pub segments: &'a [OutlineSegment],
    /// The fit of the outline to the landmark's shape class.
    pub shape_score: Option<f32>,
}

/// Makes `sighting` what the component says about the object; `score` and `distinctness` are left at 0 for the ranking.
pub fn sighting(frame: &Frame, grid: &DoubledGrid, evidence: &Evidence<'_>, sighting: &mut Sighting) {
    let (mean_x, mean_y) = evidence.component.mean_pixel();
    let (x, y) = nearest_pixel(evidence.runs, mean_x, mean_y);
    let (mut outline, mut segments) =
        (std::mem::take(&mut sighting.outline), std::mem::take(&mut sighting.segments));
    grow_outline(grid, evidence.outline, &mut outline);
    segments.clear();
    segments.extend(evidence.segments.iter().map(|segment| grown_segment(grid, segment)));
    *sighting = Sighting {
        centroid: grid.frame_from_mask(mean_x, mean_y),
        area_px2: own_area_px2(grid, evidence.component, evidence.outline) as f32,
        mask_area_2x: bwarea(evidence.mask, evidence.runs) as f32,
        outline,
        segments,
        shape_score: evidence.shape_score,
        observed: WindowSums::at(frame, grid, x, y).stats(),
        score: 0.0,
        distinctness: 0.0,
    };
}

/// MATLAB's `bwarea` of a component, in samples of the doubled grid: every 2×2 neighbourhood counts 0, 1/4, 1/2, 7/8 or
/// 1 by its set pixels, two diagonal ones 3/4.
///
/// That is the number of pixels and 1/8 for each place where a run's end has a pixel diagonally before it: three set
/// pixels have one such place, two diagonal ones two.
#[must_use]
pub fn bwarea(mask: &BitMask, runs: &[Run]) -> f64 {
    let diagonal = |run: &Run| {
        let (before, after, y) = (run.x_start as i32 - 1, run.x_end as i32, run.y as i32);
        [(before, y - 1), (after, y - 1), (before, y + 1), (after, y + 1)]
            .into_iter()
            .filter(|&(x, y)| mask.get_signed(x, y))
            .count()
    };
    let pixels: u64 = runs.iter().map(|run| u64::from(run.length())).sum();
    let diagonals: usize = runs.iter().map(diagonal).sum();
    pixels as f64 + diagonals as f64 / 8.0
}

/// The object's own area: the component, holes filled, grown back by the window. Exact for outlines whose rows and
/// columns are single runs; bays narrower than the window are lost.
#[must_use]
pub fn own_area_px2(grid: &DoubledGrid, component: &Component, outline: &Outline) -> f64 {
    let window = grid.window();
    let (wider, higher) = (f64::from(window.width - 1), f64::from(window.height - 1));
    let grown = outline.enclosed_pixels()
        + wider * f64::from(component.height())
        + higher * f64::from(component.width())
        + wider * higher;
    DoubledGrid::area_px2_from_samples(grown)
}

/// The pixel of the component that is nearest to (`x`, `y`).
fn nearest_pixel(runs: &[Run], x: f64, y: f64) -> (u32, u32) {
    let candidates = runs.iter().map(|run| {
        let column = x.clamp(f64::from(run.x_start), f64::from(run.x_end - 1)).round() as u32;
        ((f64::from(column) - x).hypot(f64::from(run.y) - y), (column, run.y))
    });
    candidates.min_by(|(a, _), (b, _)| a.total_cmp(b)).map_or((0, 0), |(_, pixel)| pixel)
}

/// Makes `points` the outline of the grown component, without the points that a straight line replaces.
fn grow_outline(grid: &DoubledGrid, outline: &Outline, points: &mut Vec<PointPx>) {
    let pixels = outline.pixels();
    let grown = |at: usize| {
        let (bx, by) = outline.pixel_after(at, -2);
        let (ax, ay) = outline.pixel_after(at, 2);
        let (x, y) = pixels[at];
        grow(grid, (f64::from(x), f64::from(y)), (f64::from(ax - bx), f64::from(ay - by)))
    };
    points.clear();
    let mut from = 0;
    while from < pixels.len() {
        points.push(grown(from));
        from = straight_until(pixels, from);
    }
}

/// The furthest border pixel that a line from number `from` reaches without leaving those between behind; the number of
/// pixels where that is the end.
///
/// Every pixel passed narrows the cone of directions that stay near it (Williams 1978); the first pixel outside the cone
/// ends the line.
fn straight_until(pixels: &[(i32, i32)], from: usize) -> usize {
    let origin = pixels[from];
    let mut cone: Option<((f64, f64), (f64, f64))> = None;
    for (end, &(x, y)) in pixels.iter().enumerate().skip(from + 1) {
        let to = (f64::from(x - origin.0), f64::from(y - origin.1));
        if cone.is_some_and(|(left, right)| cross(left, to) < 0.0 || cross(to, right) < 0.0) {
            return end - 1;
        }
        let distance = to.0.hypot(to.1);
        if distance <= OUTLINE_TOLERANCE {
            continue;
        }
        let aside = (-to.1 * OUTLINE_TOLERANCE / distance, to.0 * OUTLINE_TOLERANCE / distance);
        let (left, right) = ((to.0 - aside.0, to.1 - aside.1), (to.0 + aside.0, to.1 + aside.1));
        cone = Some(cone.map_or((left, right), |(narrow_left, narrow_right)| {
            let left = if cross(narrow_left, left) > 0.0 { left } else { narrow_left };
            let right = if cross(right, narrow_right) > 0.0 { right } else { narrow_right };
            (left, right)
        }));
    }
    pixels.len()
}

fn cross(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

fn grown_segment(grid: &DoubledGrid, segment: &OutlineSegment) -> Segment {
    let heading = (segment.to.0 - segment.from.0, segment.to.1 - segment.from.1);
    Segment { from: grow(grid, segment.from, heading), to: grow(grid, segment.to, heading) }
}

/// The point of the object's border that belongs to a point of the component's, where the border runs along `heading`:
/// half a window further out, at the window's corner where the border is slanted.
fn grow(grid: &DoubledGrid, (x, y): (f64, f64), heading: (f64, f64)) -> PointPx {
    let length = heading.0.hypot(heading.1).max(f64::EPSILON);
    // Travel is clockwise, so outside is to the left. Slants of less than a quarter grow in proportion.
    let outward = |component: f64| (4.0 * component / length).clamp(-1.0, 1.0) / 2.0;
    let window = grid.window();
    grid.frame_from_mask(
        x + outward(heading.1) * f64::from(window.width),
        y + outward(-heading.0) * f64::from(window.height),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::Components;
    use crate::geometry::RectPx;
    use crate::landmark::WindowPx;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bwarea_is_the_sum_over_all_neighbourhoods(
            pixels in prop::collection::vec(prop::bool::weighted(0.6), 12 * 7),
        ) {
            let mut mask = BitMask::new(12, 7);
            for (at, _) in pixels.iter().enumerate().filter(|&(_, &set)| set) {
                mask.set(at as u32 % 12, at as u32 / 12);
            }
            let mut components = Components::default();
            components.find(&mask);
            let sum: f64 =
                components.list().iter().map(|component| bwarea(&mask, components.runs(component))).sum();
            let mut expected = 0.0;
            for (x, y) in (-1..7).flat_map(|y| (-1..12).map(move |x| (x, y))) {
                let set = [(x, y), (x + 1, y + 1), (x + 1, y), (x, y + 1)].map(|(x, y)| mask.get_signed(x, y));
                expected += match set.iter().filter(|&&set| set).count() {
                    2 if set[0] == set[1] => 0.75,
                    count => [0.0, 0.25, 0.5, 0.875, 1.0][count],
                };
            }
            prop_assert!((sum - expected).abs() < 1e-9, "{sum} is not {expected}");
        }
    }

    #[test]
    fn a_rectangle_eroded_by_the_window_measures_as_itself() {
        let region = RectPx { x: 0, y: 0, width: 60, height: 50 };
        let grid = DoubledGrid::new(region, WindowPx { width: 12, height: 8 }).unwrap();
        // An object over pixels 10..30 × 12..26: windows inside it start at samples 20..=48 and 24..=44.
        let mut mask = BitMask::new(grid.mask_width(), grid.mask_height());
        (24..=44).for_each(|y| mask.set_run(y, 20, 49));
        let mut components = Components::default();
        components.find(&mask);
        let component = components.list()[0];
        let mut outline = Outline::default();
        outline.trace(&mask, components.runs(&component)[0]);
        let frame = Frame::from_rgb(60, 50, vec![7; 9000]).unwrap();
        let runs = components.runs(&component);
        let evidence = Evidence {
            mask: &mask,
            component: &component,
            runs,
            outline: &outline,
            segments: &[],
            shape_score: None,
        };
        let mut seen = Sighting::default();
        sighting(&frame, &grid, &evidence, &mut seen);
        let sighting = seen;
        assert_eq!(sighting.area_px2, 20.0 * 14.0);
        assert_eq!(sighting.centroid, PointPx::new(20.0, 19.0));
        assert_eq!(sighting.outline.len(), 4);
        assert_eq!(sighting.outline[0], PointPx::new(10.0, 12.0));
        assert_eq!(sighting.observed.mean, [7.0; 3]);
    }
}
