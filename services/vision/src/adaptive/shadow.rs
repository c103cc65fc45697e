//! The shadow that an object casts on what it stands before.
//!
//! A shadow dims a surface and keeps its colour: it lies on the line from the surface's colour through black. Where that
//! comes near the landmark's colour, as on a floor of a lighter tone of it, object and shadow make one seed. They are told
//! apart by the direction of their colours, object's and surface's, which neither faces turned from the light nor
//! penumbras change.

use super::likeness::Likeness;
use super::memory::{CollectIn, List};
use super::palette::{Cluster, dot, levels, minus};
use super::patch::{Patch, polygon_area_and_centroid};
use crate::frame::Frame;

/// Part of a surface's light that its shadow keeps.
const SHADE: (f32, f32) = (0.15, 0.85);
/// Surfaces that are darker than this cast no shadow that could be told, levels.
const LEAST_LIGHT: f32 = 60.0;
/// A surface around the object covers at least this part of its surroundings.
const LEAST_SURFACE: f32 = 0.15;
/// A first look takes for shadow what is nearer to a surface's line than to the landmark's by so much, levels,
const CLEARLY_NEARER: f32 = 2.5;
/// and no further from the surface's line than this part of its own brightness: the sky tints shadows, as do things nearby.
const LARGEST_TINT: f32 = 0.12;
/// Object and shadow are told apart where their colours differ by this aside from brightness, levels.
const LEAST_CONTRAST: f32 = 5.0;
/// and by this many times their spread; halves of one colour are 1.3 apart.
const LEAST_SEPARATION: f32 = 2.2;
/// Less than this part of a seed is no shadow worth a thought, and more than that part is no shadow of it.
const PART: (f32, f32) = (0.015, 0.6);
/// An object of which so much is shadow is nothing else.
const NEXT_TO_ALL: f32 = 0.8;
/// One pixel of so many tells whether to look closely.
const GLIMPSE: usize = 3;
/// Next to a shadow's edge colours are mixed, px.
const BLUR_PX: i32 = 2;
/// Directions are settled in so many rounds.
const ROUNDS: usize = 2;

/// A shadow in a seed.
pub(super) struct Cast<'s> {
    /// Its pixels.
    pub(super) patch: Patch<'s>,
    /// The seed without it.
    pub(super) rest: Patch<'s>,
    /// Colour of the shadow and of the surface, levels.
    shadow: [f32; 3],
    surface: [f32; 3],
}

impl Cast<'_> {
    /// Squared distance of a colour from the nearest mixture of shadow and surface, levels².
    #[inline(always)]
    pub(super) fn distance2(&self, color: [f32; 3]) -> f32 {
        let (along, from) = (minus(self.surface, self.shadow), minus(color, self.shadow));
        let length2 = dot(along, along);
        let part = dot(from, along) / if length2 > 1.0 { length2 } else { 1.0 };
        // Plainer than `f32::clamp` and `map`, so that compilers take many at a time.
        let part = if part > 0.0 { part } else { 0.0 };
        let part = if part < 1.0 { part } else { 1.0 };
        let off = minus(from, [part * along[0], part * along[1], part * along[2]]);
        dot(off, off)
    }
}

/// What of an object is but a shadow on one of the surfaces around it.
pub(super) enum Shade<'s> {
    None,
    /// A part beside the object itself.
    Part(Cast<'s>),
    /// Next to all: what casts it is elsewhere, or out of the picture.
    All,
}

/// The shadow in `seed`, an object as it was found, on one of the `surfaces` around it.
pub(super) fn shade<'s>(
    frame: &Frame,
    seed: &Patch<'s>,
    likeness: &Likeness<'_>,
    surfaces: &[Cluster],
) -> Shade<'s> {
    let memory = seed.memory();
    let own: List<'_, [f32; 3]> = likeness.shades().map(unit).collect_in(memory);
    let all: u32 = surfaces.iter().map(|surface| surface.pixels).sum();
    let large = |surface: &&Cluster| {
        surface.pixels as f32 >= LEAST_SURFACE * all as f32
            && dot(surface.mean, surface.mean) >= LEAST_LIGHT.powi(2)
    };
    let glimpse: List<'_, [f32; 3]> =
        seed.set_places().step_by(GLIMPSE).map(|place| color_at(frame, seed, place)).collect_in(memory);
    let shows = |surface: &Surface| {
        let shaded = glimpse.iter().filter(|color| surface.may_be_shaded(**color, &own)).count();
        2.0 * shaded as f32 >= PART.0 * glimpse.len() as f32
    };
    let surfaces = surfaces.iter().filter(large).map(Surface::of).filter(shows);
    let surfaces: List<'_, Surface> = surfaces.collect_in(memory);
    if surfaces.is_empty() {
        return Shade::None;
    }
    let pixels = smoothed(frame, seed);
    let mut largest: Option<Cast<'_>> = None;
    for surface in surfaces {
        let is_cast = pixels.iter().map(|pixel| surface.may_be_shaded(pixel.color, &own));
        let is_cast: List<'_, bool> = is_cast.collect_in(memory);
        let counted = is_cast.iter().filter(|cast| **cast).count();
        if counted as f32 >= NEXT_TO_ALL * pixels.len() as f32 {
            return Shade::All;
        }
        let cast = surface.split(&pixels, is_cast).and_then(|split| split.cast(seed, &pixels, &surface));
        largest = [largest, cast].into_iter().flatten().max_by_key(|cast| cast.patch.count());
    }
    largest.map_or(Shade::None, Shade::Part)
}

/// A surface in full light: its colour and the direction of that.
struct Surface {
    color: [f32; 3],
    line: [f32; 3],
}

impl Surface {
    fn of(cluster: &Cluster) -> Self {
        Self { color: cluster.mean, line: unit(cluster.mean) }
    }

    /// Whether a colour is darker than the surface, as a shadow on it is.
    fn is_in_shade(&self, color: [f32; 3]) -> bool {
        (SHADE.0..SHADE.1).contains(&(dot(color, self.line) / dot(self.color, self.line)))
    }

    /// Whether it is clearly nearer to the surface's line than to the landmark's.
    fn may_be_shaded(&self, color: [f32; 3], own: &[[f32; 3]]) -> bool {
        let off = aside(color, self.line);
        self.is_in_shade(color)
            && off <= largest_tint(color)
            && off + CLEARLY_NEARER < least_aside(color, own)
    }

    /// Settles what is shadow and what is object from a first guess.
    fn split<'s>(&self, pixels: &[Pixel], mut is_cast: List<'s, bool>) -> Option<Split<'s>> {
        let mut colours = None;
        for _ in 0..ROUNDS {
            let mean_of = |wanted: bool| {
                let those = pixels.iter().zip(&is_cast).filter(move |(_, cast)| **cast == wanted);
                mean(those.map(|(pixel, _)| pixel.color))
            };
            let counted = is_cast.iter().filter(|cast| **cast).count() as f32;
            let (shadow, object) = (mean_of(true), unit(mean_of(false)));
            let is_part = (PART.0..PART.1).contains(&(counted / pixels.len() as f32));
            if !is_part
                || aside(shadow, self.line) > largest_tint(shadow)
                || aside(shadow, object) < LEAST_CONTRAST
            {
                return None;
            }
            colours = Some((shadow, object));
            for (pixel, cast) in pixels.iter().zip(&mut is_cast) {
                let nearer = aside(pixel.color, unit(shadow)) < aside(pixel.color, object);
                *cast = nearer && self.is_in_shade(pixel.color);
            }
        }
        colours.map(|(shadow, object)| Split { is_cast, shadow, object })
    }
}

/// Which pixels of an object are shadow.
struct Split<'s> {
    is_cast: List<'s, bool>,
    /// The shadow's colour.
    shadow: [f32; 3],
    /// Direction of the object's colour.
    object: [f32; 3],
}

impl<'s> Split<'s> {
    /// The shadow, where it stands apart from the object and the object is rounder without it.
    fn cast(&self, seed: &Patch<'s>, pixels: &[Pixel], surface: &Surface) -> Option<Cast<'s>> {
        if self.separation(pixels) < LEAST_SEPARATION {
            return None;
        }
        let mut patch = Patch::empty(seed.memory(), seed.rect);
        let those = pixels.iter().zip(&self.is_cast).filter(|(_, cast)| **cast);
        those.for_each(|(pixel, _)| patch.set(pixel.x, pixel.y));
        let patch = patch.opened(1);
        let rest = remains(seed, &patch)?;
        let rounder = solidity(&rest) > solidity(seed);
        rounder.then_some(Cast { patch, rest, shadow: self.shadow, surface: surface.color })
    }

    /// How far apart object and shadow are by their distances from both lines, over the sum of their standard
    /// deviations: told by medians, since the pixels on edges are mixtures.
    fn separation(&self, pixels: &[Pixel]) -> f32 {
        let line = unit(self.shadow);
        let of = |wanted: bool| {
            let those = pixels.iter().zip(&self.is_cast).filter(|(_, cast)| **cast == wanted);
            let nearer = those.map(|(pixel, _)| aside(pixel.color, line) - aside(pixel.color, self.object));
            let mut nearer: List<'_, f32> = nearer.collect_in(self.is_cast.bump());
            let middle = median(&mut nearer);
            nearer.iter_mut().for_each(|value| *value = (*value - middle).abs());
            // Half of a normal distribution lies within 0.67 standard deviations.
            (middle, median(&mut nearer) / 0.67)
        };
        let ((object, object_spread), (shadow, shadow_spread)) = (of(false), of(true));
        (object - shadow) / (object_spread + shadow_spread).max(0.1)
    }
}

fn largest_tint(shadow: [f32; 3]) -> f32 {
    LARGEST_TINT * dot(shadow, shadow).sqrt()
}

fn median(values: &mut [f32]) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// What remains of the seed without the shadow and the blur around it; `None` where there is next to no shadow.
fn remains<'s>(seed: &Patch<'s>, shadow: &Patch<'_>) -> Option<Patch<'s>> {
    let worth = shadow.count() as f32 >= PART.0 * seed.count() as f32;
    let bare = worth.then(|| seed.without(&shadow.dilated(BLUR_PX)).opened(1))?;
    bare.parts_overlapping(seed, 1.0)
}

fn solidity(patch: &Patch<'_>) -> f32 {
    let hull = polygon_area_and_centroid(&patch.hull()).map_or(0.0, |(area, _)| area);
    patch.count() as f32 / hull.max(1.0)
}

/// A pixel of a seed with the mean colour of its neighbours in the seed, levels.
struct Pixel {
    x: i32,
    y: i32,
    color: [f32; 3],
}

fn smoothed<'s>(frame: &Frame, seed: &Patch<'s>) -> List<'s, Pixel> {
    let pixel = |(x, y)| Pixel { x, y, color: mean_around(frame, seed, x, y) };
    seed.set_places().map(pixel).collect_in(seed.memory())
}

/// Mean colour of a pixel of the seed and those of its eight neighbours that are too.
fn mean_around(frame: &Frame, seed: &Patch<'_>, x: i32, y: i32) -> [f32; 3] {
    let (mut sum, mut n) = ([0_u32; 3], 0_u32);
    for v in y - 1..=y + 1 {
        let mut bits = seed.bits_from(x - 1, v) & 0b111;
        if bits == 0 {
            continue;
        }
        n += bits.count_ones();
        let row = frame.row(seed.rect.y + v as u32);
        while bits != 0 {
            let column = seed.rect.x as usize + (x - 1 + bits.trailing_zeros() as i32) as usize;
            for (total, level) in sum.iter_mut().zip(&row[3 * column..3 * column + 3]) {
                *total += u32::from(*level);
            }
            bits &= bits - 1;
        }
    }
    sum.map(|total| total as f32 / n.max(1) as f32)
}

fn color_at(frame: &Frame, seed: &Patch<'_>, (x, y): (i32, i32)) -> [f32; 3] {
    levels(frame.pixel(seed.rect.x + x as u32, seed.rect.y + y as u32))
}

fn mean(colours: impl Iterator<Item = [f32; 3]>) -> [f32; 3] {
    let (mut n, mut sum) = (0.0_f32, [0.0_f32; 3]);
    for color in colours {
        n += 1.0;
        sum.iter_mut().zip(color).for_each(|(total, level)| *total += level);
    }
    sum.map(|total| total / n.max(1.0))
}

/// Distance of a colour from the line through black in a direction of length 1, levels.
fn aside(color: [f32; 3], direction: [f32; 3]) -> f32 {
    let along = dot(color, direction);
    (dot(color, color) - along * along).max(0.0).sqrt()
}

fn least_aside(color: [f32; 3], directions: &[[f32; 3]]) -> f32 {
    directions.iter().map(|direction| aside(color, *direction)).fold(f32::MAX, f32::min)
}

fn unit(color: [f32; 3]) -> [f32; 3] {
    let length = dot(color, color).sqrt().max(1e-3);
    color.map(|level| level / length)
}
