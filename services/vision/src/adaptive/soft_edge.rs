//! Sub-pixel centroid and area: every pixel on the edge counts by the part of it that shows the object.
//!
//! That part is told from the pixel's colour, between the object's colour next to it and the background's next to it.

use super::neighbours::{Around, around};
use super::palette::{dot, levels, minus};
use super::patch::Patch;
use crate::frame::Frame;
use crate::geometry::PointPx;

/// Object and background nearer than this cannot be told apart by mixing, levels².
const LEAST_CONTRAST2: f32 = 150.0;
/// A border nearer than this to the background is not looked for, levels².
const BORDER_CONTRAST2: f32 = 3600.0;

/// What the edge of an object is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Edge {
    /// Object next to background.
    Plain,
    /// A sign's border of this colour lies between them, at most so many pixels wide.
    Bordered {
        /// Colour of the border, levels.
        color: [f32; 3],
        /// Greatest width, px.
        width_px: i32,
    },
}

/// Centre of gravity and area of the object with soft edges; `None` of nothing.
pub(crate) fn centroid_and_area(frame: &Frame, object: &Patch<'_>, edge: Edge) -> Option<(PointPx, f32)> {
    let inner = object.eroded(1);
    let deep = inner.eroded(1);
    let inside = if deep.count() >= 6 { &deep } else { &inner };
    let width_px = match edge {
        Edge::Plain => 1,
        Edge::Bordered { width_px, .. } => width_px,
    };
    let outer = object.dilated(width_px);
    let background = outer.dilated(1).inverted();
    let rim = outer.without(&inner);
    let mut moments = Moments::of(&inner);
    for (place, around) in rim.set_places().zip(around(frame, &rim, inside, &background)) {
        let mixed =
            Mixed { color: color_at(frame, object, place), hard: object.get(place.0, place.1), around };
        moments.add(place, mixed.covered_share(edge));
    }
    moments.centre_in(object).map(|centre| (centre, moments.weight as f32))
}

/// Centre of gravity and area of a board with a border all around, of which the object is all but the border; `None` of
/// nothing. Before the sky a border cannot be seen: so the centre is that of what lies within it, and its width that on the
/// sides where it can be seen.
pub(crate) fn within_border(
    frame: &Frame,
    object: &Patch<'_>,
    (own, border): ([f32; 3], [f32; 3]),
    width_px: i32,
) -> Option<(PointPx, f32)> {
    let inner = object.eroded(1);
    let outer = object.dilated(width_px);
    let background = outer.dilated(1).inverted();
    let edge = outer.without(&inner);
    let mut moments = Moments::of(&inner);
    let rim = object.dilated(1).without(object);
    let (mut seen, mut length) = (0.0_f32, 0.0_f32);
    for ((x, y), around) in edge.set_places().zip(around(frame, &edge, &inner, &background)) {
        let mixed = Mixed { color: color_at(frame, object, (x, y)), hard: object.get(x, y), around };
        let (own, border) = mixed.shares_with_border(own, border);
        moments.add((x, y), own);
        if let Some(border) = border {
            seen += border;
            length += if rim.get(x, y) { 1.0 } else { 0.0 };
        }
    }
    let width_px = if length > 0.0 { (seen / length).min(width_px as f32) } else { 0.0 };
    let area_px2 = moments.weight as f32 + width_px * rim.count() as f32;
    moments.centre_in(object).map(|centre| (centre, area_px2))
}

/// Zeroth and first moments of pixels that count by a part, in the frame of a patch.
struct Moments {
    weight: f64,
    x: f64,
    y: f64,
}

impl Moments {
    /// Of pixels that count wholly.
    fn of(pixels: &Patch<'_>) -> Self {
        let (mut n, mut columns, mut rows) = (0, 0, 0);
        pixels.each_run(|run| {
            let length = u64::from(run.length());
            n += length;
            columns += length * u64::from(run.x_start + run.x_end - 1) / 2;
            rows += length * u64::from(run.y);
        });
        // Whole and half numbers: these sums are exact.
        let half = 0.5 * n as f64;
        Self { weight: n as f64, x: columns as f64 + half, y: rows as f64 + half }
    }

    fn add(&mut self, (x, y): (i32, i32), share: f32) {
        let share = f64::from(share);
        self.weight += share;
        self.x += share * (f64::from(x) + 0.5);
        self.y += share * (f64::from(y) + 0.5);
    }

    /// Centre of gravity in frame pixels, of pixels of `patch`; `None` of nothing.
    fn centre_in(&self, patch: &Patch<'_>) -> Option<PointPx> {
        let (x, y) =
            (f64::from(patch.rect.x) + self.x / self.weight, f64::from(patch.rect.y) + self.y / self.weight);
        (self.weight > 0.0).then(|| PointPx::new(x as f32, y as f32))
    }
}

/// A pixel on the edge of an object.
struct Mixed {
    color: [f32; 3],
    /// Whether it counts as the object's where nothing tells its part.
    hard: bool,
    around: Around,
}

impl Mixed {
    /// The part of the pixel that shows the object, 0..1.
    fn covered_share(&self, edge: Edge) -> f32 {
        let Around { own: Some(own), other: Some(other) } = self.around else { return self.hard_share() };
        let plain = share_between(self.color, own, other).unwrap_or(self.hard_share());
        match edge {
            Edge::Plain => plain,
            Edge::Bordered { color: border, .. } => share_of_two(self.color, own, border, other)
                .map_or(plain, |(own, border)| (own + border).clamp(0.0, 1.0)),
        }
    }

    /// The part that shows the object, and that which shows its border, where that can be told.
    fn shares_with_border(&self, own: [f32; 3], border: [f32; 3]) -> (f32, Option<f32>) {
        let shares = self.around.other.and_then(|other| share_of_two(self.color, own, border, other));
        match shares {
            Some((own, border)) => {
                let own = own.clamp(0.0, 1.0);
                (own, Some(border.clamp(0.0, 1.0 - own)))
            }
            // The border, if it is one, is of nearly the background's colour.
            None => (share_between(self.color, own, border).unwrap_or(self.hard_share()), None),
        }
    }

    fn hard_share(&self) -> f32 {
        if self.hard { 1.0 } else { 0.0 }
    }
}

fn color_at(frame: &Frame, object: &Patch<'_>, (x, y): (i32, i32)) -> [f32; 3] {
    levels(frame.pixel(object.rect.x + x as u32, object.rect.y + y as u32))
}

/// The part of `own` in a mixture of `own` and `other`; `None` where they are too much alike.
fn share_between(color: [f32; 3], own: [f32; 3], other: [f32; 3]) -> Option<f32> {
    let (mixed, contrast) = (minus(color, other), minus(own, other));
    let contrast2 = dot(contrast, contrast);
    (contrast2 >= LEAST_CONTRAST2).then(|| (dot(mixed, contrast) / contrast2).clamp(0.0, 1.0))
}

/// The parts of `own` and `border` in a mixture of both with `other` (least squares); `None` where the
/// border looks like the background.
fn share_of_two(color: [f32; 3], own: [f32; 3], border: [f32; 3], other: [f32; 3]) -> Option<(f32, f32)> {
    let (p, a, b) = (minus(color, other), minus(own, other), minus(border, other));
    let (aa, ab, bb) = (dot(a, a), dot(a, b), dot(b, b));
    let determinant = aa * bb - ab * ab;
    if bb < BORDER_CONTRAST2 || determinant < 0.1 * aa * bb {
        return None;
    }
    let of_own = (dot(p, a) * bb - dot(p, b) * ab) / determinant;
    let of_border = (dot(p, b) * aa - dot(p, a) * ab) / determinant;
    Some((of_own, of_border))
}
