//! The shadow that an object casts on what it stands before.
//!
//! A shadow dims a surface and keeps its colour: it lies on the line from the surface's colour through black. Where that
//! comes near the landmark's colour, as on a floor of a lighter tone of it, object and shadow make one seed. They are told
//! apart by the direction of their colours, object's and surface's, which neither faces turned from the light nor
//! penumbras change.

use super::likeness::Likeness;
use super::palette::{Cluster, levels};
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
/// Next to a shadow's edge colours are mixed, px.
const BLUR_PX: i32 = 2;
/// Directions are settled in so many rounds.
const ROUNDS: usize = 2;

/// A shadow in a seed.
pub(super) struct Cast {
    /// Its pixels.
    pub(super) patch: Patch,
    /// The seed without it.
    pub(super) rest: Patch,
    /// Colour of the shadow and of the surface, levels.
    shadow: [f32; 3],
    surface: [f32; 3],
}

impl Cast {
    /// Squared distance of a colour from the nearest mixture of shadow and surface, levels².
    pub(super) fn distance2(&self, color: [f32; 3]) -> f32 {
        let (along, from) = (minus(self.surface, self.shadow), minus(color, self.shadow));
        let part = (dot(from, along) / dot(along, along).max(1.0)).clamp(0.0, 1.0);
        let off = minus(from, along.map(|level| part * level));
        dot(off, off)
    }
}

/// The shadow of one of the `surfaces` around it that `seed` holds beside the object.
pub(super) fn cast(frame: &Frame, seed: &Patch, likeness: &Likeness, surfaces: &[Cluster]) -> Option<Cast> {
    let own: Vec<[f32; 3]> = likeness.shades().map(unit).collect();
    let all: u32 = surfaces.iter().map(|surface| surface.pixels).sum();
    let large = |surface: &&Cluster| {
        surface.pixels as f32 >= LEAST_SURFACE * all as f32
            && dot(surface.mean, surface.mean) >= LEAST_LIGHT.powi(2)
    };
    let pixels = smoothed(frame, seed);
    let casts =
        surfaces.iter().filter(large).filter_map(|surface| of_surface(seed, &pixels, &own, surface.mean));
    casts.max_by_key(|cast| cast.patch.count())
}

fn of_surface(seed: &Patch, pixels: &[Pixel], own: &[[f32; 3]], surface: [f32; 3]) -> Option<Cast> {
    let light = dot(surface, surface).sqrt();
    let line = unit(surface);
    let in_shade = |color: [f32; 3]| (SHADE.0..SHADE.1).contains(&(dot(color, line) / light));
    let mut is_cast: Vec<bool> = pixels
        .iter()
        .map(|pixel| {
            let off = aside(pixel.color, line);
            in_shade(pixel.color)
                && off <= largest_tint(pixel.color)
                && off + CLEARLY_NEARER < least_aside(pixel.color, own)
        })
        .collect();
    let (mut own, mut shadow) = (own.to_vec(), surface);
    for _ in 0..ROUNDS {
        let counted = is_cast.iter().filter(|cast| **cast).count() as f32;
        if !(PART.0..PART.1).contains(&(counted / pixels.len() as f32)) {
            return None;
        }
        shadow = mean(pixels.iter().zip(&is_cast).filter(|(_, cast)| **cast).map(|(pixel, _)| pixel.color));
        let object =
            mean(pixels.iter().zip(&is_cast).filter(|(_, cast)| !**cast).map(|(pixel, _)| pixel.color));
        if aside(shadow, line) > largest_tint(shadow) || aside(shadow, unit(object)) < LEAST_CONTRAST {
            return None;
        }
        own = vec![unit(object)];
        let line = unit(shadow);
        for (pixel, cast) in pixels.iter().zip(&mut is_cast) {
            *cast = in_shade(pixel.color) && aside(pixel.color, line) < least_aside(pixel.color, &own);
        }
    }
    if separation(pixels, &is_cast, unit(shadow), &own) < LEAST_SEPARATION {
        return None;
    }
    let mut patch = Patch::empty(seed.rect);
    pixels.iter().zip(&is_cast).filter(|(_, cast)| **cast).for_each(|(pixel, _)| patch.set(pixel.x, pixel.y));
    let patch = patch.opened(1);
    let rest = remains(seed, &patch)?;
    (solidity(&rest) > solidity(seed)).then_some(Cast { patch, rest, shadow, surface })
}

fn largest_tint(shadow: [f32; 3]) -> f32 {
    LARGEST_TINT * dot(shadow, shadow).sqrt()
}

/// How far apart object and shadow are by their distances from both lines, over the sum of their standard deviations:
/// told by medians, since the pixels on edges are mixtures.
fn separation(pixels: &[Pixel], is_cast: &[bool], line: [f32; 3], own: &[[f32; 3]]) -> f32 {
    let of = |wanted: bool| {
        let those = pixels.iter().zip(is_cast).filter(|(_, cast)| **cast == wanted);
        let nearer: Vec<f32> =
            those.map(|(pixel, _)| aside(pixel.color, line) - least_aside(pixel.color, own)).collect();
        let middle = median(nearer.clone());
        // Half of a normal distribution lies within 0.67 standard deviations.
        (middle, median(nearer.into_iter().map(|value| (value - middle).abs()).collect()) / 0.67)
    };
    let ((object, object_spread), (shadow, shadow_spread)) = (of(false), of(true));
    (object - shadow) / (object_spread + shadow_spread).max(0.1)
}

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// What remains of the seed without the shadow and the blur around it; `None` where there is next to no shadow.
fn remains(seed: &Patch, shadow: &Patch) -> Option<Patch> {
    let worth = shadow.count() as f32 >= PART.0 * seed.count() as f32;
    let bare = worth.then(|| seed.without(&shadow.dilated(BLUR_PX)).opened(1))?;
    bare.parts_overlapping(seed, 1.0)
}

fn solidity(patch: &Patch) -> f32 {
    let hull = polygon_area_and_centroid(&patch.hull()).map_or(0.0, |(area, _)| area);
    patch.count() as f32 / hull.max(1.0)
}

/// A pixel of a seed with the mean colour of its neighbours in the seed, levels.
struct Pixel {
    x: i32,
    y: i32,
    color: [f32; 3],
}

fn smoothed(frame: &Frame, seed: &Patch) -> Vec<Pixel> {
    let level = |x: i32, y: i32| levels(frame.pixel(seed.rect.x + x as u32, seed.rect.y + y as u32));
    seed.set_places()
        .map(|(x, y)| {
            let near = (y - 1..=y + 1).flat_map(|v| (x - 1..=x + 1).map(move |u| (u, v)));
            let color = mean(near.filter(|&(u, v)| seed.get(u, v)).map(|(u, v)| level(u, v)));
            Pixel { x, y, color }
        })
        .collect()
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

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
