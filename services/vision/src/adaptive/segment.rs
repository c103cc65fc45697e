//! Object or background, pixel by pixel, around a seed.
//!
//! The object's colours come from the seed, the background's from a ring around it, so shadows and whatever it stands
//! before count as background without a threshold: a pixel belongs to whichever it is nearer to, where the object may
//! be lighter or darker along its own shading line.

use super::likeness::{Likeness, LitFaces};
use super::memory::List;
use super::nearer::Nearer;
use super::palette::{Cluster, palette};
use super::patch::Patch;
use super::shadow::{self, Cast, Shade};
use crate::frame::Frame;
use crate::geometry::RectPx;

/// Colours closer than this count as one, levels.
const RADIUS: f32 = 16.0;
const OBJECT_COLOURS: usize = 6;
const BACKGROUND_COLOURS: usize = 16;
/// Palettes are told from about this many pixels.
const PALETTE_SAMPLES: usize = 700;
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

/// An object told from its background.
pub(crate) struct Segmented<'s> {
    pub(crate) object: Patch<'s>,
    /// Whether it is but the shadow of something on what lies around it.
    pub(crate) is_shadow: bool,
}

/// The pixels of the object that `seed` is part of, without the shadow that it casts. The seed's rectangle must leave room
/// around it.
pub(crate) fn object<'s>(
    frame: &Frame,
    seed: &Patch<'s>,
    likeness: &Likeness<'_>,
    parts: Parts,
) -> Option<Segmented<'s>> {
    let near = seed.dilated(reach_px(seed));
    let surfaces = background_colours(frame, seed, &near, likeness);
    let object = grown(frame, (seed, &near), &surfaces, None, parts)?;
    // Signs stand above the ground.
    if likeness.face().is_some() {
        return Some(Segmented { object, is_shadow: false });
    }
    match shadow::shade(frame, &object, likeness, &surfaces) {
        Shade::None => Some(Segmented { object, is_shadow: false }),
        Shade::All => Some(Segmented { object, is_shadow: true }),
        Shade::Part(cast) => {
            let near = cast.rest.dilated(reach_px(&cast.rest));
            let object = grown(frame, (&cast.rest, &near), &surfaces, Some(&cast), parts)?;
            Some(Segmented { object, is_shadow: false })
        }
    }
}

/// The pixels `near` a seed that are nearer to its colours than to those of the `surfaces` around it.
fn grown<'s>(
    frame: &Frame,
    (seed, near): (&Patch<'s>, &Patch<'s>),
    surfaces: &[Cluster],
    cast: Option<&Cast<'_>>,
    parts: Parts,
) -> Option<Patch<'s>> {
    let own = object_colours(frame, seed);
    let sure = seed.eroded(2);
    // What lies well inside the seed or its shadow needs no asking.
    let mut unsure = near.without(&sure);
    if let Some(cast) = cast {
        unsure = unsure.without(&cast.patch.eroded(1));
    }
    let asked = unsure.judged(frame, &Nearer { own: &own, others: surfaces, cast });
    let mut object = asked.with(&sure);
    if seed.count() as f32 >= OPENING_SIZE_PX * OPENING_SIZE_PX {
        object = object.opened(1);
    }
    let least = match parts {
        Parts::Largest => 1.0,
        Parts::All => 0.1,
    };
    object.parts_overlapping(seed, least).map(|part| part.filled())
}

/// How far beyond a seed the object may reach.
fn reach_px(seed: &Patch<'_>) -> i32 {
    (0.3 * (seed.count() as f32).sqrt()).ceil().max(2.0) as i32
}

/// A rectangle around `bounds` with room for the background to show itself.
pub(crate) fn surroundings(bounds: RectPx, frame: &Frame) -> RectPx {
    let margin = (bounds.width.max(bounds.height) / 2).clamp(6, 48);
    let (x, y) = (bounds.x.saturating_sub(margin), bounds.y.saturating_sub(margin));
    let width = (bounds.x + bounds.width + margin).min(frame.width()) - x;
    let height = (bounds.y + bounds.height + margin).min(frame.height()) - y;
    RectPx { x, y, width, height }
}

fn object_colours<'s>(frame: &Frame, seed: &Patch<'s>) -> List<'s, Cluster> {
    let core = seed.eroded(1);
    let core = if 3 * core.count() >= seed.count() { &core } else { seed };
    let mut colours = palette(seed.memory(), sampled(frame, core, PALETTE_SAMPLES), RADIUS, OBJECT_COLOURS);
    let all: u32 = colours.iter().map(|cluster| cluster.pixels).sum();
    colours.retain(|cluster| 25 * cluster.pixels >= all);
    colours
}

/// Colours around the seed that are not the landmark's own, nor mixtures with those of a lit face beside the seed.
fn background_colours<'s>(
    frame: &Frame,
    seed: &Patch<'s>,
    near: &Patch<'_>,
    likeness: &Likeness<'_>,
) -> List<'s, Cluster> {
    let ring = near.without(&seed.dilated(2));
    let lit = ring.judged(frame, &LitFaces(likeness));
    let foreign = ring.without(&lit).without(&ring.judged(frame, likeness));
    let clear = ring.without(&lit.dilated(2));
    // A sign has one face, and lettering of any colour.
    let ring = if likeness.face().is_none() && 3 * clear.count() >= ring.count() { clear } else { ring };
    let places = sampled_places(&ring, PALETTE_SAMPLES).filter(|&(x, y)| foreign.get(x, y));
    let seen = places.map(|(x, y)| frame.pixel(ring.rect.x + x as u32, ring.rect.y + y as u32));
    palette(seed.memory(), seen, RADIUS, BACKGROUND_COLOURS)
}

/// Pixels of a patch, evenly thinned out to about `samples` where there are many.
pub(super) fn sampled<'a>(
    frame: &'a Frame,
    patch: &'a Patch<'_>,
    samples: usize,
) -> impl Iterator<Item = [u8; 3]> + 'a {
    let places = sampled_places(patch, samples);
    places.map(|(x, y)| frame.pixel(patch.rect.x + x as u32, patch.rect.y + y as u32))
}

fn sampled_places(patch: &Patch<'_>, samples: usize) -> impl Iterator<Item = (i32, i32)> {
    let step = (patch.count() / samples).max(1);
    // An odd step does not fall into line with the rows of even patches.
    patch.set_places().step_by(step | 1)
}
