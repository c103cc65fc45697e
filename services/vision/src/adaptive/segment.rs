//! Object or background, pixel by pixel, around a seed.
//!
//! The object's colours come from the seed, the background's from a ring around it, so shadows and whatever it stands
//! before count as background without a threshold: a pixel belongs to whichever it is nearer to, where the object may
//! be lighter or darker along its own shading line.

use super::likeness::Likeness;
use super::palette::{Cluster, distance2, levels, nearest, palette};
use super::patch::Patch;
use crate::frame::Frame;
use crate::geometry::RectPx;

/// How much darker or lighter than its palette the object's pixels may be.
const SHADING: (f32, f32) = (0.82, 1.18);
/// Colours closer than this count as one, levels.
const RADIUS: f32 = 16.0;
const OBJECT_COLOURS: usize = 6;
const BACKGROUND_COLOURS: usize = 16;
/// Whiskers are cut off objects of at least this many pixels across.
const OPENING_SIZE_PX: f32 = 11.0;

/// Which connected parts make one object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Parts {
    /// The one that shares most with the seed.
    Largest,
    /// All that share a good deal with the seed: lettering separates them.
    All,
}

/// The pixels of the object that `seed` is part of. The seed's rectangle must leave room around it.
pub(crate) fn object(frame: &Frame, seed: &Patch, likeness: &Likeness, parts: Parts) -> Option<Patch> {
    let size_px = (seed.count() as f32).sqrt();
    let reach = (0.3 * size_px).ceil().max(2.0) as i32;
    let own = object_colours(frame, seed);
    let near = seed.dilated(reach);
    let others = background_colours(frame, seed, &near, likeness);
    let pixel = |x: i32, y: i32| levels(frame.pixel(seed.rect.x + x as u32, seed.rect.y + y as u32));
    let is_object = |x: i32, y: i32| {
        let color = pixel(x, y);
        let from_background = nearest(&others, color).map_or(f32::MAX, |(_, d2)| d2);
        near.get(x, y) && own.iter().any(|own| shading_distance2(own.mean, color) < from_background)
    };
    let mut object = Patch::from_fn(seed.rect, is_object);
    if size_px >= OPENING_SIZE_PX {
        object = object.opened(1);
    }
    let least = match parts {
        Parts::Largest => 1.0,
        Parts::All => 0.1,
    };
    object.parts_overlapping(seed, least).map(|part| part.filled())
}

/// A rectangle around `bounds` with room for the background to show itself.
pub(crate) fn surroundings(bounds: RectPx, frame: &Frame) -> RectPx {
    let margin = (bounds.width.max(bounds.height) / 2).clamp(6, 48);
    let (x, y) = (bounds.x.saturating_sub(margin), bounds.y.saturating_sub(margin));
    let width = (bounds.x + bounds.width + margin).min(frame.width()) - x;
    let height = (bounds.y + bounds.height + margin).min(frame.height()) - y;
    RectPx { x, y, width, height }
}

fn object_colours(frame: &Frame, seed: &Patch) -> Vec<Cluster> {
    let core = seed.eroded(1);
    let core = if 3 * core.count() >= seed.count() { &core } else { seed };
    let pixels = core.set_places().map(|(x, y)| frame.pixel(seed.rect.x + x as u32, seed.rect.y + y as u32));
    let mut colours = palette(pixels, RADIUS, OBJECT_COLOURS);
    let least = core.count() as u32 / 25;
    colours.retain(|cluster| cluster.pixels >= least);
    colours
}

/// Colours around the seed that are not the landmark's own.
fn background_colours(frame: &Frame, seed: &Patch, near: &Patch, likeness: &Likeness) -> Vec<Cluster> {
    let close = seed.dilated(2);
    let pixels = near
        .places()
        .filter(|&(x, y)| !close.get(x, y))
        .map(|(x, y)| frame.pixel(seed.rect.x + x as u32, seed.rect.y + y as u32))
        .filter(|&pixel| !likeness.matches(pixel));
    palette(pixels, RADIUS, BACKGROUND_COLOURS)
}

/// Squared distance of `color` from `own` with the light that suits it best, levels².
fn shading_distance2(own: [f32; 3], color: [f32; 3]) -> f32 {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let gain = (dot(own, color) / dot(own, own).max(1.0)).clamp(SHADING.0, SHADING.1);
    distance2(own.map(|level| level * gain), color)
}
