//! A small binary picture cut out of a frame, and the morphology done on it.

use crate::bitmask::Run;
use crate::geometry::{PointPx, RectPx};

/// Set and unset pixels of a rectangle of the frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Which part of the frame.
    pub(crate) rect: RectPx,
    cells: Vec<bool>,
}

impl Patch {
    pub(crate) fn empty(rect: RectPx) -> Self {
        Self { rect, cells: vec![false; rect.width as usize * rect.height as usize] }
    }

    /// The pixels of `runs`, whose coordinates count from the corner of `origin`.
    pub(crate) fn from_runs(rect: RectPx, origin: RectPx, runs: &[Run]) -> Self {
        let mut patch = Self::empty(rect);
        for run in runs {
            let (x, y) = ((origin.x + run.x_start) as i32, (origin.y + run.y) as i32);
            for x in x..x + run.length() as i32 {
                patch.set(x - rect.x as i32, y - rect.y as i32);
            }
        }
        patch
    }

    pub(crate) fn width(&self) -> i32 {
        self.rect.width as i32
    }

    pub(crate) fn height(&self) -> i32 {
        self.rect.height as i32
    }

    /// Whether a pixel is set; outside the patch none is.
    pub(crate) fn get(&self, x: i32, y: i32) -> bool {
        self.index(x, y).is_some_and(|at| self.cells[at])
    }

    /// Sets a pixel; outside the patch nothing happens.
    pub(crate) fn set(&mut self, x: i32, y: i32) {
        if let Some(at) = self.index(x, y) {
            self.cells[at] = true;
        }
    }

    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let inside = x >= 0 && y >= 0 && x < self.width() && y < self.height();
        inside.then(|| y as usize * self.rect.width as usize + x as usize)
    }

    pub(crate) fn count(&self) -> usize {
        self.cells.iter().filter(|&&set| set).count()
    }

    /// The rectangle around the set pixels, in the frame; `None` of nothing.
    pub(crate) fn bounds(&self) -> Option<RectPx> {
        let (mut left, mut top, mut right, mut bottom) = (i32::MAX, i32::MAX, 0, 0);
        for (x, y) in self.set_places() {
            (left, top, right, bottom) = (left.min(x), top.min(y), right.max(x + 1), bottom.max(y + 1));
        }
        (left < right).then(|| RectPx {
            x: self.rect.x + left as u32,
            y: self.rect.y + top as u32,
            width: (right - left) as u32,
            height: (bottom - top) as u32,
        })
    }

    /// Every pixel's place in the patch.
    pub(crate) fn places(&self) -> impl Iterator<Item = (i32, i32)> + use<> {
        let (width, height) = (self.width(), self.height());
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    /// The set pixels' places in the patch.
    pub(crate) fn set_places(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        self.places().zip(&self.cells).filter(|(_, set)| **set).map(|(at, _)| at)
    }

    /// The pixels for which `keep` holds.
    pub(crate) fn from_fn(rect: RectPx, mut keep: impl FnMut(i32, i32) -> bool) -> Self {
        let mut patch = Self::empty(rect);
        let places = patch.places();
        for (at, (x, y)) in places.enumerate() {
            patch.cells[at] = keep(x, y);
        }
        patch
    }

    /// Grown by `reach` pixels in all eight directions.
    pub(crate) fn dilated(&self, reach: i32) -> Self {
        let across = self.swept(reach, |patch, x, y, step| patch.get(x + step, y));
        across.swept(reach, |patch, x, y, step| patch.get(x, y + step))
    }

    /// Shrunk by `reach` pixels in all eight directions; the frame's own border does not shrink it, so that an object
    /// cut by the picture's edge keeps its core. `frame_edge` says whether a place lies beyond the frame.
    pub(crate) fn eroded(&self, reach: i32) -> Self {
        let mut outside = self.clone();
        outside.cells.iter_mut().for_each(|set| *set = !*set);
        let mut inside = outside.dilated(reach);
        inside.cells.iter_mut().for_each(|set| *set = !*set);
        inside
    }

    /// Eroded and dilated again: thin attachments are gone.
    pub(crate) fn opened(&self, reach: i32) -> Self {
        let mut opened = self.eroded(reach).dilated(reach);
        opened.keep_only(self);
        opened
    }

    fn swept(&self, reach: i32, hit: impl Fn(&Self, i32, i32, i32) -> bool) -> Self {
        Self::from_fn(self.rect, |x, y| (-reach..=reach).any(|step| hit(self, x, y, step)))
    }

    /// Unsets what is not set in `other`.
    pub(crate) fn keep_only(&mut self, other: &Self) {
        for (cell, keep) in self.cells.iter_mut().zip(&other.cells) {
            *cell &= keep;
        }
    }

    /// The 4-connected part that overlaps `seed` most, with every other whose overlap is at least `least` of that.
    pub(crate) fn parts_overlapping(&self, seed: &Self, least: f32) -> Option<Self> {
        let mut seen = Self::empty(self.rect);
        let mut parts: Vec<(usize, Self)> = Vec::new();
        for (x, y) in self.places() {
            if self.get(x, y) && !seen.get(x, y) {
                let part = self.flooded(x, y, &mut seen);
                let overlap = part.set_places().filter(|&(u, v)| seed.get(u, v)).count();
                parts.push((overlap, part));
            }
        }
        let most = parts.iter().map(|(overlap, _)| *overlap).max().filter(|&most| most > 0)?;
        let mut kept = parts.into_iter().filter(|(overlap, _)| *overlap as f32 >= least * most as f32);
        let (_, mut union) = kept.next()?;
        for (_, part) in kept {
            union.cells.iter_mut().zip(&part.cells).for_each(|(cell, more)| *cell |= more);
        }
        Some(union)
    }

    fn flooded(&self, x: i32, y: i32, seen: &mut Self) -> Self {
        let mut part = Self::empty(self.rect);
        let mut open = vec![(x, y)];
        seen.set(x, y);
        while let Some((x, y)) = open.pop() {
            part.set(x, y);
            for (u, v) in [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)] {
                if self.get(u, v) && !seen.get(u, v) {
                    seen.set(u, v);
                    open.push((u, v));
                }
            }
        }
        part
    }

    /// With its holes filled: unset pixels that are not connected with the patch's edge.
    pub(crate) fn filled(&self) -> Self {
        let (width, height) = (self.width(), self.height());
        let mut reached = Self::empty(self.rect);
        let mut open: Vec<(i32, i32)> = Vec::new();
        let mut visit = |x: i32, y: i32, open: &mut Vec<(i32, i32)>| {
            let inside = x >= 0 && y >= 0 && x < width && y < height;
            if inside && !self.get(x, y) && !reached.get(x, y) {
                reached.set(x, y);
                open.push((x, y));
            }
        };
        for x in 0..width {
            visit(x, 0, &mut open);
            visit(x, height - 1, &mut open);
        }
        for y in 0..height {
            visit(0, y, &mut open);
            visit(width - 1, y, &mut open);
        }
        while let Some((x, y)) = open.pop() {
            for (u, v) in [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)] {
                visit(u, v, &mut open);
            }
        }
        Self::from_fn(self.rect, |x, y| !reached.get(x, y))
    }

    /// The corners of the convex hull of the set pixels (their squares, not their centres), counter-clockwise in a
    /// frame with y down, in frame pixels.
    pub(crate) fn hull(&self) -> Vec<PointPx> {
        let mut corners: Vec<(i32, i32)> = Vec::new();
        for y in 0..self.height() {
            let row: Vec<i32> = (0..self.width()).filter(|&x| self.get(x, y)).collect();
            if let (Some(&first), Some(&last)) = (row.first(), row.last()) {
                corners.extend([(first, y), (first, y + 1), (last + 1, y), (last + 1, y + 1)]);
            }
        }
        corners.sort_unstable();
        corners.dedup();
        let half = |points: &mut dyn Iterator<Item = &(i32, i32)>| {
            let mut chain: Vec<(i32, i32)> = Vec::new();
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
        hull.into_iter().map(|(u, v)| PointPx::new(x + u as f32, y + v as f32)).collect()
    }

    /// With every pixel set whose centre lies in the convex hull.
    pub(crate) fn convex(&self) -> Self {
        let hull = self.hull();
        let (left, top) = (self.rect.x as f32, self.rect.y as f32);
        let inside = |x: i32, y: i32| {
            let (px, py) = (left + x as f32 + 0.5, top + y as f32 + 0.5);
            hull.iter()
                .zip(hull.iter().cycle().skip(1))
                .all(|(a, b)| (b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x) >= 0.0)
        };
        Self::from_fn(self.rect, |x, y| self.get(x, y) || (!hull.is_empty() && inside(x, y)))
    }

    /// Whether a set pixel lies on the border of a picture of that size.
    pub(crate) fn touches_border(&self, width: u32, height: u32) -> bool {
        self.set_places().any(|(x, y)| {
            let (u, v) = (self.rect.x + x as u32, self.rect.y + y as u32);
            u == 0 || v == 0 || u + 1 == width || v + 1 == height
        })
    }
}

fn cross(a: (i32, i32), b: (i32, i32), c: (i32, i32)) -> i64 {
    let along = (i64::from(b.0 - a.0), i64::from(b.1 - a.1));
    let aside = (i64::from(c.0 - a.0), i64::from(c.1 - a.1));
    along.0 * aside.1 - along.1 * aside.0
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

#[cfg(test)]
mod tests {
    use super::*;

    const RECT: RectPx = RectPx { x: 10, y: 20, width: 12, height: 9 };

    fn ring() -> Patch {
        Patch::from_fn(RECT, |x, y| (2..9).contains(&x) && (2..8).contains(&y) && (x, y) != (5, 5))
    }

    #[test]
    fn holes_are_filled_and_nothing_else() {
        assert_eq!(ring().count(), 41);
        assert_eq!(ring().filled().count(), 42);
    }

    #[test]
    fn opening_takes_whiskers_away() {
        let mut whiskered = ring().filled();
        let plain = whiskered.clone();
        whiskered.set(9, 5);
        whiskered.set(10, 5);
        assert_eq!(whiskered.opened(1), plain);
    }

    #[test]
    fn the_hull_of_a_rectangle_is_the_rectangle() {
        let hull = ring().hull();
        assert_eq!(hull.len(), 4);
        let (area, centre) = polygon_area_and_centroid(&hull).unwrap();
        assert_eq!((area, centre), (42.0, PointPx::new(15.5, 25.0)));
    }

    #[test]
    fn the_part_with_the_seed_is_kept() {
        let two = Patch::from_fn(RECT, |x, _| !(3..=8).contains(&x));
        let seed = Patch::from_fn(RECT, |x, y| x == 10 && y == 4);
        assert_eq!(two.parts_overlapping(&seed, 1.0).unwrap().count(), 27);
    }
}
