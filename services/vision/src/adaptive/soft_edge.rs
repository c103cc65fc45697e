//! Sub-pixel centroid and area: every pixel on the edge counts by the part of it that shows the object.
//!
//! That part is told from the pixel's colour, between the object's colour next to it and the background's next to it.

use super::palette::{dot, levels, minus};
use super::patch::{Patch, set_bits};
use crate::frame::Frame;
use crate::geometry::PointPx;

/// How far a pure neighbour may be from an edge pixel, px.
const REACH: i32 = 4;
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
    let inside = object.eroded(2);
    let inside = if inside.count() >= 6 { inside } else { object.eroded(1) };
    let inner = object.eroded(1);
    let width_px = match edge {
        Edge::Plain => 1,
        Edge::Bordered { width_px, .. } => width_px,
    };
    let outer = object.dilated(width_px);
    let background = outer.dilated(1).inverted();
    let pure = Pure { frame, object, inside: &inside, background: &background };
    let mut moments = Moments::of(&inner);
    outer.without(&inner).set_places().for_each(|place| moments.add(place, pure.covered_share(place, edge)));
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
    let pure = Pure { frame, object, inside: &inner, background: &background };
    let mut moments = Moments::of(&inner);
    let rim = object.dilated(1).without(object);
    let (mut seen, mut length) = (0.0_f32, 0.0_f32);
    for (x, y) in outer.without(&inner).set_places() {
        let (own, border) = pure.shares_with_border((x, y), own, border);
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
        let mut moments = Self { weight: 0.0, x: 0.0, y: 0.0 };
        pixels.set_places().for_each(|place| moments.add(place, 1.0));
        moments
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

/// Where only the object and where only the background shows.
struct Pure<'a> {
    frame: &'a Frame,
    object: &'a Patch<'a>,
    inside: &'a Patch<'a>,
    background: &'a Patch<'a>,
}

impl Pure<'_> {
    /// The part of an edge pixel that shows the object, 0..1.
    fn covered_share(&self, (x, y): (i32, i32), edge: Edge) -> f32 {
        let hard = if self.object.get(x, y) { 1.0 } else { 0.0 };
        let own = local_mean(self.frame, self.inside, (x, y));
        let other = local_mean(self.frame, self.background, (x, y));
        let (Some(own), Some(other)) = (own, other) else { return hard };
        let rect = self.object.rect;
        let color = levels(self.frame.pixel(rect.x + x as u32, rect.y + y as u32));
        let plain = share_between(color, own, other).unwrap_or(hard);
        match edge {
            Edge::Plain => plain,
            Edge::Bordered { color: border, .. } => share_of_two(color, own, border, other)
                .map_or(plain, |(own, border)| (own + border).clamp(0.0, 1.0)),
        }
    }

    /// The part of an edge pixel that shows the object, and that which shows its border, where that can be told.
    fn shares_with_border(&self, (x, y): (i32, i32), own: [f32; 3], border: [f32; 3]) -> (f32, Option<f32>) {
        let hard = if self.object.get(x, y) { 1.0 } else { 0.0 };
        let other = local_mean(self.frame, self.background, (x, y));
        let rect = self.object.rect;
        let color = levels(self.frame.pixel(rect.x + x as u32, rect.y + y as u32));
        let Some(other) = other else { return (share_between(color, own, border).unwrap_or(hard), None) };
        match share_of_two(color, own, border, other) {
            Some((own, border)) => {
                let own = own.clamp(0.0, 1.0);
                (own, Some(border.clamp(0.0, 1.0 - own)))
            }
            // The border, if it is one, is of nearly the background's colour.
            None => (share_between(color, own, border).unwrap_or(hard), None),
        }
    }
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

/// What a neighbour at a distance of (dx, dy) weighs: near ones tell more of the light on the edge than far ones.
const NEARNESS: [[f32; SPAN]; SPAN] = {
    let mut nearness = [[0.0; SPAN]; SPAN];
    let mut at = 0;
    while at < SPAN * SPAN {
        let (dx, dy) = ((at % SPAN) as i32 - REACH, (at / SPAN) as i32 - REACH);
        nearness[at / SPAN][at % SPAN] = 1.0 / (1 + dx * dx + dy * dy) as f32;
        at += 1;
    }
    nearness
};
const SPAN: usize = 2 * REACH as usize + 1;

/// Mean colour of the pixels of `pure` around a place.
fn local_mean(frame: &Frame, pure: &Patch<'_>, (x, y): (i32, i32)) -> Option<[f32; 3]> {
    let (mut sum, mut n) = ([0.0_f32; 3], 0.0_f32);
    for (row, v) in (y - REACH..=y + REACH).enumerate() {
        let bits = pure.bits_from(x - REACH, v) & ((1 << SPAN) - 1);
        if bits == 0 {
            continue;
        }
        let pixels = frame.row(pure.rect.y + v as u32);
        let left = pure.rect.x as i32 + x - REACH;
        for column in set_bits(bits) {
            let nearness = NEARNESS[row][column as usize];
            let at = 3 * (left + column) as usize;
            for c in 0..3 {
                sum[c] += nearness * f32::from(pixels[at + c]);
            }
            n += nearness;
        }
    }
    (n > 0.0).then(|| sum.map(|s| s / n))
}
