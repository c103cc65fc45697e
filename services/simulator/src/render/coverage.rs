//! How much of each pixel a polygon covers, exactly.

use std::ops::Range;

use crate::polygon::Point;

/// A rectangle of pixels on the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Region {
    pub(crate) columns: Range<usize>,
    pub(crate) rows: Range<usize>,
}

impl Region {
    /// The pixels that a polygon inside the frame touches.
    pub(crate) fn around([left, top, right, bottom]: [f64; 4]) -> Self {
        let range = |from: f64, to: f64| from.floor().max(0.0) as usize..to.ceil().max(0.0) as usize;
        Self { columns: range(left, right), rows: range(top, bottom) }
    }

    pub(crate) fn pixels(&self) -> usize {
        self.columns.len() * self.rows.len()
    }
}

/// Covered parts of the pixels of a region, 0..1, row after row.
#[derive(Debug, Default)]
pub(crate) struct Coverage {
    cells: Vec<f32>,
    parts: Vec<f32>,
}

impl Coverage {
    /// The covered parts for a polygon that lies wholly inside `region`.
    ///
    /// Each piece of an edge inside one pixel adds the strip between itself and the right border of its row; summed
    /// from the left these strips leave exactly the polygon.
    pub(crate) fn of(&mut self, polygon: &[Point], region: &Region) -> &[f32] {
        let stride = region.columns.len() + 2;
        self.cells.clear();
        self.cells.resize(stride * region.rows.len(), 0.0);
        let (left, top) = (region.columns.start as f64, region.rows.start as f64);
        for (i, to) in polygon.iter().enumerate() {
            let from = polygon[(i + polygon.len() - 1) % polygon.len()];
            self.add_edge([from[0] - left, from[1] - top], [to[0] - left, to[1] - top], stride);
        }
        self.parts.clear();
        for row in self.cells.chunks_exact(stride) {
            let mut sum = 0.0_f32;
            self.parts.extend(row[..stride - 2].iter().map(|cell| {
                sum += cell;
                sum.abs().min(1.0)
            }));
        }
        &self.parts
    }

    fn add_edge(&mut self, from: Point, to: Point, stride: usize) {
        let (upper, lower, sign) = if from[1] < to[1] { (from, to, 1.0) } else { (to, from, -1.0) };
        if lower[1] <= upper[1] {
            return;
        }
        let slope = (lower[0] - upper[0]) / (lower[1] - upper[1]);
        let x_at = |y: f64| upper[0] + (y - upper[1]) * slope;
        for row in upper[1].floor() as usize..lower[1].ceil() as usize {
            let y0 = upper[1].max(row as f64);
            let y1 = lower[1].min((row + 1) as f64);
            let cells = self.cells.iter_mut().skip(row * stride).take(stride);
            add_within_row(cells, x_at(y0), x_at(y1), sign * (y1 - y0));
        }
    }
}

/// Spreads an edge of height `height` from `x0` to `x1` inside one row over the pixels that it passes.
fn add_within_row<'a>(cells: impl Iterator<Item = &'a mut f32>, x0: f64, x1: f64, height: f64) {
    let (left, right) = (x0.min(x1).max(0.0), x0.max(x1).max(0.0));
    let first = left.floor() as usize;
    let last = (right.ceil() as usize).max(first + 1);
    let mut carried = 0.0;
    for (column, cell) in cells.enumerate().skip(first).take(last - first + 1) {
        let from = left.max(column as f64);
        let to = right.min((column + 1) as f64);
        let piece = match (to >= from, right > left) {
            (false, _) => 0.0,
            (true, true) => height * (to - from) / (right - left),
            (true, false) => height,
        };
        let inside = ((from + to) / 2.0 - column as f64).clamp(0.0, 1.0);
        *cell += (carried + piece * (1.0 - inside)) as f32;
        carried = piece * inside;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polygon::{Moments, bounds, hull};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg32;

    #[test]
    fn a_square_between_pixels_covers_their_parts() {
        let square = [[1.25, 1.5], [3.0, 1.5], [3.0, 3.0], [1.25, 3.0]];
        let region = Region { columns: 0..4, rows: 0..4 };
        let mut coverage = Coverage::default();
        let parts = coverage.of(&square, &region);
        let expected = [0.0, 0.0, 0.0, 0.0, 0.0, 0.375, 0.5, 0.0, 0.0, 0.75, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(parts, expected);
    }

    #[test]
    fn covered_parts_add_up_to_area_and_centroid() {
        let mut random = Pcg32::seed_from_u64(7);
        let mut coverage = Coverage::default();
        for _ in 0..200 {
            let polygon = hull(
                (0..6).map(|_| [random.random_range(0.0..40.0), random.random_range(0.0..30.0)]).collect(),
            );
            let region = Region::around(bounds(&polygon));
            let parts = coverage.of(&polygon, &region);
            let moments = Moments::of(&polygon);
            let area: f64 = parts.iter().map(|&part| f64::from(part)).sum();
            assert!((area - moments.area_px2).abs() < 1e-3, "{area} {}", moments.area_px2);
            assert!(parts.iter().all(|part| (0.0..=1.0).contains(part)));
        }
    }

    #[test]
    fn every_pixel_agrees_with_counting_points() {
        let polygon = hull(vec![[2.3, 1.1], [17.9, 3.2], [14.2, 16.8], [0.4, 9.9]]);
        let region = Region { columns: 0..20, rows: 0..20 };
        let mut coverage = Coverage::default();
        let parts = coverage.of(&polygon, &region).to_vec();
        let inside = |x: f64, y: f64| {
            (0..polygon.len()).all(|i| {
                let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0.0
            })
        };
        for (index, part) in parts.iter().enumerate() {
            let (column, row) = ((index % 20) as f64, (index / 20) as f64);
            let hits = (0..32 * 32)
                .filter(|i| {
                    inside(column + (f64::from(i % 32) + 0.5) / 32.0, row + (f64::from(i / 32) + 0.5) / 32.0)
                })
                .count();
            assert!((hits as f64 / 1024.0 - f64::from(*part)).abs() < 0.03, "pixel {column} {row}: {part}");
        }
    }
}
