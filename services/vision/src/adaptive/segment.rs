//! Object or background, pixel by pixel, around a seed.
//!
//! The object's colours come from the seed, the background's from a ring around it, so shadows and whatever it stands
//! before count as background without a threshold: a pixel belongs to whichever it is nearer to, where the object may
//! be lighter or darker along its own shading line.

use super::likeness::Likeness;
use super::memory::List;
use super::palette::{Cluster, levels, palette};
use super::patch::Patch;
use super::shadow::{self, Cast, Shade};
use crate::frame::Frame;
use crate::geometry::RectPx;

/// How much darker or lighter than its palette the object's pixels may be, and how much lighter at no cost: a face turned
/// to the light is much lighter than the others.
const SHADING: (f32, f32) = (0.82, 1.7);
const FREE_LIGHT: f32 = 1.18;
/// What a level beyond the free shading costs, levels.
const SHADING_COST: f32 = 0.4;
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
    let surfaces = background_colours(frame, seed, &seed.dilated(reach_px(seed)), likeness);
    let object = grown(frame, seed, &surfaces, None, parts)?;
    // Signs stand above the ground.
    if likeness.face().is_some() {
        return Some(Segmented { object, is_shadow: false });
    }
    match shadow::shade(frame, &object, likeness, &surfaces) {
        Shade::None => Some(Segmented { object, is_shadow: false }),
        Shade::All => Some(Segmented { object, is_shadow: true }),
        Shade::Part(cast) => {
            let object = grown(frame, &cast.rest, &surfaces, Some(&cast), parts)?;
            Some(Segmented { object, is_shadow: false })
        }
    }
}

/// The pixels around `seed` that are nearer to its colours than to those of the `surfaces` around it.
fn grown<'s>(
    frame: &Frame,
    seed: &Patch<'s>,
    surfaces: &[Cluster],
    cast: Option<&Cast<'_>>,
    parts: Parts,
) -> Option<Patch<'s>> {
    let near = seed.dilated(reach_px(seed));
    let own = Shaded::new(&object_colours(frame, seed));
    let others = Plain::new(surfaces);
    let sure = seed.eroded(2);
    let sure_shadow =
        cast.map_or_else(|| Patch::empty(seed.memory(), seed.rect), |cast| cast.patch.eroded(1));
    // What lies well inside the seed needs no asking: its colours are the object's.
    let asked = near.without(&sure).without(&sure_shadow).only(|x, y| {
        let color = levels(frame.pixel(seed.rect.x + x as u32, seed.rect.y + y as u32));
        let shadow2 = cast.map_or(f32::MAX, |cast| cast.distance2(color));
        own.distance2(color) < others.distance2(color).min(shadow2)
    });
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
    let foreign = |pixel: &[u8; 3]| !likeness.matches(*pixel) && !likeness.is_lit_face(*pixel);
    let ring = near.without(&seed.dilated(2));
    let lit =
        ring.only(|x, y| likeness.is_lit_face(frame.pixel(seed.rect.x + x as u32, seed.rect.y + y as u32)));
    let clear = ring.without(&lit.dilated(2));
    // A sign has one face, and lettering of any colour.
    let ring = if likeness.face().is_none() && 3 * clear.count() >= ring.count() { clear } else { ring };
    let seen = sampled(frame, &ring, PALETTE_SAMPLES).filter(foreign);
    palette(seed.memory(), seen, RADIUS, BACKGROUND_COLOURS)
}

/// Pixels of a patch, evenly thinned out to about `samples` where there are many.
pub(super) fn sampled<'a>(
    frame: &'a Frame,
    patch: &'a Patch<'_>,
    samples: usize,
) -> impl Iterator<Item = [u8; 3]> + 'a {
    let step = (patch.count() / samples).max(1);
    // An odd step does not fall into line with the rows of even patches.
    let places = patch.set_places().step_by(step | 1);
    places.map(|(x, y)| frame.pixel(patch.rect.x + x as u32, patch.rect.y + y as u32))
}

/// A palette whose distances are taken all at once; empty places are far from every colour.
struct Plain {
    means: [[f32; BACKGROUND_COLOURS]; 3],
}

const FAR: f32 = 1e6;

impl Plain {
    fn new(colours: &[Cluster]) -> Self {
        let mut means = [[FAR; BACKGROUND_COLOURS]; 3];
        for (at, cluster) in colours.iter().enumerate().take(BACKGROUND_COLOURS) {
            for (means, mean) in means.iter_mut().zip(cluster.mean) {
                means[at] = mean;
            }
        }
        Self { means }
    }

    /// Squared distance from the nearest colour, levels².
    fn distance2(&self, color: [f32; 3]) -> f32 {
        let [r, g, b] = &self.means;
        let mut distances = [0.0_f32; BACKGROUND_COLOURS];
        for at in 0..BACKGROUND_COLOURS {
            let (dr, dg, db) = (r[at] - color[0], g[at] - color[1], b[at] - color[2]);
            distances[at] = dr * dr + dg * dg + db * db;
        }
        least(distances)
    }
}

/// A palette of the object's colours, each with more or less light on it.
struct Shaded {
    means: [[f32; 8]; 3],
    /// Squared length of each mean, and one over it.
    length2: [f32; 8],
    inverse: [f32; 8],
}

impl Shaded {
    fn new(colours: &[Cluster]) -> Self {
        let mut this = Self { means: [[FAR; 8]; 3], length2: [0.0; 8], inverse: [0.0; 8] };
        for (at, cluster) in colours.iter().enumerate().take(8) {
            for (means, mean) in this.means.iter_mut().zip(cluster.mean) {
                means[at] = mean;
            }
            this.length2[at] = cluster.mean.iter().map(|m| m * m).sum::<f32>().max(1.0);
            this.inverse[at] = 1.0 / this.length2[at];
        }
        this
    }

    /// Squared distance from the nearest colour with the light that suits it best, levels².
    fn distance2(&self, color: [f32; 3]) -> f32 {
        let [r, g, b] = &self.means;
        let mut distances = [0.0_f32; 8];
        for at in 0..8 {
            let along = r[at] * color[0] + g[at] * color[1] + b[at] * color[2];
            let gain = along * self.inverse[at];
            let gain = if gain > SHADING.0 { gain } else { SHADING.0 };
            let gain = if gain < SHADING.1 { gain } else { SHADING.1 };
            let (dr, dg, db) = (gain * r[at] - color[0], gain * g[at] - color[1], gain * b[at] - color[2]);
            let beyond = if gain > FREE_LIGHT { SHADING_COST * (gain - FREE_LIGHT) } else { 0.0 };
            let cost = beyond * beyond * self.length2[at];
            distances[at] = dr * dr + dg * dg + db * db + cost;
        }
        least(distances)
    }
}

/// The least of several numbers, by halves.
fn least<const N: usize>(mut values: [f32; N]) -> f32 {
    let mut half = N / 2;
    while half > 0 {
        for at in 0..half {
            // Plainer than `f32::min`, which has to think of what is no number.
            values[at] = if values[at] < values[at + half] { values[at] } else { values[at + half] };
        }
        half /= 2;
    }
    values[0]
}
