//! Sub-pixel centroid and area: every pixel on the edge counts by the part of it that shows the object.
//!
//! That part is told from the pixel's colour, between the object's colour next to it and the background's next to it.

use super::palette::levels;
use super::patch::Patch;
use crate::frame::Frame;
use crate::geometry::PointPx;

/// How far a pure neighbour may be from an edge pixel, px.
const REACH: i32 = 4;
/// Object and background nearer than this cannot be told apart by mixing, levels².
const LEAST_CONTRAST2: f32 = 150.0;

/// Centre of gravity and area of the object with soft edges; `None` of nothing.
pub(crate) fn centroid_and_area(frame: &Frame, object: &Patch) -> Option<(PointPx, f32)> {
    let inside = object.eroded(2);
    let inside = if inside.count() >= 6 { inside } else { object.eroded(1) };
    let inner = object.eroded(1);
    let outer = object.dilated(1);
    let beyond = outer.dilated(1);
    let (mut weight, mut mx, mut my) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (x, y) in outer.set_places() {
        let share =
            if inner.get(x, y) { 1.0 } else { covered_share(frame, object, &inside, &beyond, (x, y)) };
        weight += f64::from(share);
        mx += f64::from(share) * (f64::from(x) + 0.5);
        my += f64::from(share) * (f64::from(y) + 0.5);
    }
    let (x, y) = (f64::from(object.rect.x) + mx / weight, f64::from(object.rect.y) + my / weight);
    (weight > 0.0).then(|| (PointPx::new(x as f32, y as f32), weight as f32))
}

/// The part of an edge pixel that shows the object, 0..1.
fn covered_share(frame: &Frame, object: &Patch, inside: &Patch, beyond: &Patch, (x, y): (i32, i32)) -> f32 {
    let hard = if object.get(x, y) { 1.0 } else { 0.0 };
    let own = local_mean(frame, object, (x, y), |u, v| inside.get(u, v));
    let other = local_mean(frame, object, (x, y), |u, v| !beyond.get(u, v));
    let (Some(own), Some(other)) = (own, other) else { return hard };
    let color = levels(frame.pixel(object.rect.x + x as u32, object.rect.y + y as u32));
    let (mut along, mut contrast2) = (0.0, 0.0);
    for c in 0..3 {
        along += (color[c] - other[c]) * (own[c] - other[c]);
        contrast2 += (own[c] - other[c]).powi(2);
    }
    if contrast2 < LEAST_CONTRAST2 { hard } else { (along / contrast2).clamp(0.0, 1.0) }
}

/// Mean colour of the pixels around a place for which `pure` holds.
fn local_mean(
    frame: &Frame,
    patch: &Patch,
    (x, y): (i32, i32),
    pure: impl Fn(i32, i32) -> bool,
) -> Option<[f32; 3]> {
    let (mut sum, mut n) = ([0.0_f32; 3], 0.0_f32);
    for v in (y - REACH).max(0)..(y + REACH + 1).min(patch.height()) {
        for u in (x - REACH).max(0)..(x + REACH + 1).min(patch.width()) {
            if pure(u, v) {
                // Near neighbours tell more of the light on the edge than far ones.
                let nearness = 1.0 / (1 + (u - x).pow(2) + (v - y).pow(2)) as f32;
                let color = levels(frame.pixel(patch.rect.x + u as u32, patch.rect.y + v as u32));
                for c in 0..3 {
                    sum[c] += nearness * color[c];
                }
                n += nearness;
            }
        }
    }
    (n > 0.0).then(|| sum.map(|s| s / n))
}
