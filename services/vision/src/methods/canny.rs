//! Canny's edges (thesis 2.5): thin, and connected across places where they are weak.
//!
//! Smoothing by a Gaussian, Sobel's gradient, thinning across the gradient's nearest of four directions, then tracing
//! from strong edges along weak ones. Without smoothing and on whole levels it gives OpenCV's edges with `L2gradient`.

use super::border::Border;
use super::gradient::{Operator, gradient};
use super::low_pass::gaussian;
use super::plane::Plane;
use crate::bitmask::BitMask;

/// tan 22.5°: where one of the four directions ends and the next begins.
const TAN_EIGHTH_TURN: f32 = 0.414_213_56;

/// What is an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canny {
    /// Standard deviation of the smoothing before; none where it is not positive.
    pub sigma_px: f32,
    /// Sobel magnitudes (a step of one level gives 4) above this belong to an edge that has a strong place.
    pub weak: f32,
    /// Magnitudes above this are strong places.
    pub strong: f32,
}

impl Default for Canny {
    /// For 8-bit levels: steps of 12 levels, traced down to 5.
    fn default() -> Self {
        Self { sigma_px: 1.0, weak: 20.0, strong: 50.0 }
    }
}

impl Canny {
    /// The edges of `plane`. With thresholds in the wrong order the lower one is taken for the weak one.
    #[must_use]
    pub fn edges(&self, plane: &Plane) -> BitMask {
        let (weak, strong) = (self.weak.min(self.strong), self.weak.max(self.strong));
        let slope =
            gradient(&gaussian(plane, self.sigma_px, Border::Nearest), Operator::Sobel, Border::Nearest);
        let magnitude = slope.magnitude();
        let mut candidates = BitMask::new(plane.width(), plane.height());
        let mut edges = BitMask::new(plane.width(), plane.height());
        let mut open = Vec::new();
        for (y, x) in (0..plane.height()).flat_map(|y| (0..plane.width()).map(move |x| (y, x))) {
            let here = magnitude.get(x, y);
            if here > weak && is_ridge(&magnitude, (x, y), (slope.x.get(x, y), slope.y.get(x, y))) {
                candidates.set(x, y);
                if here > strong {
                    edges.set(x, y);
                    open.push((x, y));
                }
            }
        }
        trace(&candidates, &mut edges, open);
        edges
    }
}

/// Whether the magnitude is largest here across the edge. Of two equal ones along a row or column the first counts.
fn is_ridge(magnitude: &Plane, (x, y): (u32, u32), (slope_x, slope_y): (f32, f32)) -> bool {
    let (x, y, here) = (i64::from(x), i64::from(y), magnitude.get(x, y));
    let at = |x, y| {
        let place = Border::Zero.pixel(x, magnitude.width()).zip(Border::Zero.pixel(y, magnitude.height()));
        place.map_or(0.0, |(x, y)| magnitude.row(y as u32)[x])
    };
    let (across, down) = (slope_x.abs(), slope_y.abs());
    if down < TAN_EIGHTH_TURN * across {
        here > at(x - 1, y) && here >= at(x + 1, y)
    } else if across < TAN_EIGHTH_TURN * down {
        here > at(x, y - 1) && here >= at(x, y + 1)
    } else {
        let side = if (slope_x < 0.0) == (slope_y < 0.0) { 1 } else { -1 };
        here > at(x - side, y - 1) && here > at(x + side, y + 1)
    }
}

/// Adds to `edges` the candidates that touch them, and those that touch these.
fn trace(candidates: &BitMask, edges: &mut BitMask, mut open: Vec<(u32, u32)>) {
    while let Some((x, y)) = open.pop() {
        for y in y.saturating_sub(1)..=(y + 1).min(candidates.height() - 1) {
            for x in x.saturating_sub(1)..=(x + 1).min(candidates.width() - 1) {
                if candidates.get(x, y) && !edges.get(x, y) {
                    edges.set(x, y);
                    open.push((x, y));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SizePx;
    use crate::methods::reference::any_plane;
    use proptest::prelude::*;

    #[test]
    fn a_weak_edge_counts_where_a_strong_one_leads_to_it() {
        let size = SizePx { width: 12, height: 20 };
        // A step at column 6 that fades downwards, and a faint step by itself at column 2.
        let plane = Plane::from_fn(size, |x, y| {
            let step = if x >= 6 { 100.0 - 4.0 * y as f32 } else { 0.0 };
            step + if x >= 2 { 8.0 } else { 0.0 }
        });
        let edges = Canny { sigma_px: 0.0, weak: 20.0, strong: 200.0 }.edges(&plane);
        for y in 0..20 {
            assert!(edges.get(5, y) || edges.get(6, y), "row {y} has lost its edge");
            assert!(!edges.get(1, y) && !edges.get(2, y), "a weak edge alone is none");
        }
    }

    proptest! {
        #[test]
        fn edges_hang_together_with_strong_places(plane in any_plane(16), weak in 0f32..300.0, more in 0f32..300.0) {
            let few = Canny { sigma_px: 0.0, weak: weak + more, strong: weak + more }.edges(&plane);
            let all = Canny { sigma_px: 0.0, weak, strong: weak }.edges(&plane);
            let traced = Canny { sigma_px: 0.0, weak: weak + more, strong: weak }.edges(&plane);
            for (x, y) in (0..plane.height()).flat_map(|y| (0..plane.width()).map(move |x| (x, y))) {
                prop_assert!(!few.get(x, y) || traced.get(x, y));
                prop_assert!(!traced.get(x, y) || all.get(x, y));
            }
        }
    }
}
