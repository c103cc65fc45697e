//! The convex hull of a patch.

use super::Patch;
use crate::adaptive::memory::{CollectIn, List};
use crate::geometry::PointPx;

impl<'m> Patch<'m> {
    /// The corners of the convex hull of the set pixels (their squares, not their centres), counter-clockwise in a
    /// frame with y down, in frame pixels.
    pub(crate) fn hull(&self) -> List<'m, PointPx> {
        let runs = self.runs();
        let mut corners: List<'_, (i32, i32)> = List::with_capacity_in(4 * runs.len(), self.memory);
        for row in runs.chunk_by(|a, b| a.y == b.y) {
            let (first, end, y) = (row[0].x_start as i32, row[row.len() - 1].x_end as i32, row[0].y as i32);
            corners.extend([(first, y), (first, y + 1), (end, y), (end, y + 1)]);
        }
        corners.sort_unstable();
        corners.dedup();
        let half = |points: &mut dyn Iterator<Item = &(i32, i32)>| {
            let mut chain: List<'_, (i32, i32)> =
                List::with_capacity_in(points.size_hint().0 + 1, self.memory);
            for &point in points {
                while let [.., a, b] = chain[..]
                    && cross(a, b, point) <= 0
                {
                    chain.pop();
                }
                chain.push(point);
            }
            chain.pop();
            chain
        };
        let mut hull = half(&mut corners.iter());
        hull.extend(half(&mut corners.iter().rev()));
        let (x, y) = (self.rect.x as f32, self.rect.y as f32);
        hull.into_iter().map(|(u, v)| PointPx::new(x + u as f32, y + v as f32)).collect_in(self.memory)
    }

    /// With every pixel set whose centre lies in the convex hull.
    pub(crate) fn convex(&self) -> Self {
        let hull = self.hull();
        let mut filled = self.copy();
        for y in 0..self.rect.height {
            let (left, right) = span(&hull, (self.rect.y + y) as f32 + 0.5);
            let column =
                |x: f32| (x - self.rect.x as f32 - 0.5).ceil().clamp(0.0, self.rect.width as f32) as u32;
            // A centre that lies on the right side of the hull is inside.
            let (start, end) = (column(left), column(right.next_up()));
            filled.set_run(y, start, end.max(start));
        }
        filled
    }
}

/// The columns between which a horizontal line crosses a convex polygon; an empty span where it does not.
fn span(polygon: &[PointPx], y: f32) -> (f32, f32) {
    let mut span = (f32::INFINITY, f32::NEG_INFINITY);
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        if (a.y <= y) != (b.y <= y) {
            let x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
            span = (span.0.min(x), span.1.max(x));
        }
    }
    span
}

fn cross(a: (i32, i32), b: (i32, i32), c: (i32, i32)) -> i64 {
    let along = (i64::from(b.0 - a.0), i64::from(b.1 - a.1));
    let aside = (i64::from(c.0 - a.0), i64::from(c.1 - a.1));
    along.0 * aside.1 - along.1 * aside.0
}

/// The area of the smallest rectangle around a convex polygon, px²; it shares a side with the polygon (Freeman and
/// Shapira 1975).
pub(crate) fn enclosing_rectangle_area(hull: &[PointPx]) -> f32 {
    let along_side = |(a, b): (&PointPx, &PointPx)| {
        let length = a.distance_px(*b).max(1e-6);
        let (ux, uy) = ((b.x - a.x) / length, (b.y - a.y) / length);
        let extent = |direction: (f32, f32)| {
            let along = hull.iter().map(|p| p.x * direction.0 + p.y * direction.1);
            let (low, high) = along.fold((f32::MAX, f32::MIN), |(low, high), at| (low.min(at), high.max(at)));
            high - low
        };
        extent((ux, uy)) * extent((-uy, ux))
    };
    hull.iter().zip(hull.iter().cycle().skip(1)).map(along_side).fold(f32::MAX, f32::min)
}

/// The area inside a closed polygon, px² (shoelace formula), and its centroid.
pub(crate) fn polygon_area_and_centroid(corners: &[PointPx]) -> Option<(f32, PointPx)> {
    let origin = corners.first()?;
    let (mut doubled, mut mx, mut my) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (ax, ay) = (f64::from(a.x - origin.x), f64::from(a.y - origin.y));
        let (bx, by) = (f64::from(b.x - origin.x), f64::from(b.y - origin.y));
        let piece = ax * by - ay * bx;
        doubled += piece;
        mx += piece * (ax + bx);
        my += piece * (ay + by);
    }
    let (dx, dy) = (mx / (3.0 * doubled), my / (3.0 * doubled));
    (doubled.abs() > 1e-6)
        .then(|| ((doubled / 2.0).abs() as f32, PointPx::new(origin.x + dx as f32, origin.y + dy as f32)))
}
