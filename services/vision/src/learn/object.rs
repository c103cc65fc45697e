//! Which pixels of a bounding box are the object's: colours that fill its middle and are rare around it.

use super::windows::{Sample, stats};
use crate::adaptive::memory::Memory;
use crate::adaptive::palette::{Cluster, dot, levels, nearest, palette};
use crate::adaptive::patch::{Patch, polygon_area_and_centroid};
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::ColorStats;

/// Colours closer than this count as one, levels; wider for small regions, most of whose pixels are mixtures.
fn palette_radius(region: RectPx) -> f32 {
    let side = region.width.min(region.height) as f32;
    22.0 + (2.0 * (20.0 - side)).clamp(0.0, 18.0)
}
const PALETTE_LIMIT: usize = 24;
/// How many times denser than outside the box a colour must be in its middle to be the object's,
const DENSITY_RATIO: f32 = 3.0;
/// and what part of it at least.
const LEAST_OWN: f32 = 0.02;
/// Shades that cover less of the object are left to convex filling and soft edges.
const MIN_SHARE: f32 = 0.10;
/// A shade of which less lies outside another's outline is an inlay in it.
const OUTSIDE_PART: f32 = 0.2;
/// Colours nearer to grey have no direction to speak of, levels.
const LEAST_TINT: f32 = 20.0;
/// How far another tone of a colour is from grey, over how far the colour itself is.
const TINT_PART: std::ops::Range<f32> = 0.65..1.55;
/// Cosine of the angle between tones of one colour, seen from grey.
const SAME_DIRECTION: f32 = 0.96;

/// How tones of one colour are judged.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Tones {
    /// Each as a colour of its own: what lies between a sign's tint and its lettering is a mixture of both.
    Apart,
    /// As one colour, on which gloss lies: a frame of it spans more than the face in it.
    Together,
}

impl Tones {
    /// Whether both count as one colour.
    fn are_one(self, main: Cluster, other: Cluster) -> bool {
        main == other || (self == Self::Together && same_tint(main.mean, other.mean))
    }
}

/// The object's shades in one region and the pixels that show them.
pub(super) fn sample(frame: &Frame, region: RectPx, tones: Tones) -> Sample {
    let memory = Memory::new();
    let around = pixels(frame, neighbourhood(frame, region));
    let colours = palette(&memory, around, palette_radius(region), PALETTE_LIMIT);
    let own = object_colours(frame, region, &colours);
    let label_of = |pixel: [u8; 3]| match nearest(&colours, levels(pixel)) {
        Some((at, _)) if own[at] => Some(at),
        _ => None,
    };
    let labels: Vec<Option<usize>> = pixels(frame, region).map(label_of).collect();
    let labels = keep_shades(region, &labels, &colours, tones);
    Sample::new(frame, region, labels)
}

/// What a sign looks like from so far that lettering and border cannot be resolved: the statistics of its whole face,
/// of the largest region. `None` where its face is plain and a shade says the same.
pub(super) fn far_view(regions: &[(&Frame, RectPx)], shades: &[ColorStats]) -> Option<ColorStats> {
    let (frame, region) = regions.iter().max_by_key(|(_, region)| region.width.min(region.height))?;
    let face = (region.y..region.y + region.height)
        .flat_map(|y| (region.x..region.x + region.width).map(move |x| (x, y)))
        .filter(|&(x, y)| face_radius(*region, x, y) <= 0.9)
        .map(|(x, y)| frame.pixel(x, y).map(f64::from));
    let face = stats(face);
    let plain = |shade: &ColorStats| (0..3).all(|c| (shade.mean[c] - face.mean[c]).abs() <= SAME_AS_FACE);
    (!shades.iter().any(plain)).then_some(face)
}

fn pixels(frame: &Frame, rect: RectPx) -> impl Iterator<Item = [u8; 3]> + '_ {
    (rect.y..rect.y + rect.height)
        .flat_map(move |y| (rect.x..rect.x + rect.width).map(move |x| frame.pixel(x, y)))
}

/// The region and two fifths of its size around it.
fn neighbourhood(frame: &Frame, region: RectPx) -> RectPx {
    let margin = |side: u32| (side * 2 / 5).max(4);
    let (mx, my) = (margin(region.width), margin(region.height));
    let (x, y) = (region.x.saturating_sub(mx), region.y.saturating_sub(my));
    let width = (region.x + region.width).saturating_add(mx).min(frame.width()) - x;
    let height = (region.y + region.height).saturating_add(my).min(frame.height()) - y;
    RectPx { x, y, width, height }
}

/// For each colour whether it is the object's: much denser in the middle of the box than around the box.
fn object_colours(frame: &Frame, region: RectPx, colours: &[Cluster]) -> Vec<bool> {
    let mut middle = vec![0_u32; colours.len()];
    let mut around = vec![0_u32; colours.len()];
    let near = neighbourhood(frame, region);
    for y in near.y..near.y + near.height {
        for x in near.x..near.x + near.width {
            let Some((at, _)) = nearest(colours, levels(frame.pixel(x, y))) else { continue };
            match place(region, x, y) {
                Place::Middle => middle[at] += 1,
                Place::Around => around[at] += 1,
                Place::Edge => {}
            }
        }
    }
    let share = |counts: &[u32], at: usize| counts[at] as f32 / counts.iter().sum::<u32>().max(1) as f32;
    let ratio = |at: usize| share(&middle, at) / (share(&around, at) + 0.005);
    let mut own: Vec<bool> =
        (0..colours.len()).map(|at| ratio(at) >= DENSITY_RATIO && share(&middle, at) >= LEAST_OWN).collect();
    // A box inside a larger thing of the same colour has no outside: its commonest colour must do.
    if !own.contains(&true)
        && let Some(best) =
            (0..colours.len()).max_by(|&a, &b| share(&middle, a).total_cmp(&share(&middle, b)))
    {
        own[best] = true;
    }
    own
}

/// A face whose mean differs less than this from a shade's, in every channel, is plain, levels.
const SAME_AS_FACE: f32 = 12.0;

enum Place {
    Middle,
    Edge,
    Around,
}

/// How far a pixel lies from the middle of the region, in half sides.
fn offsets(region: RectPx, x: u32, y: u32) -> (f32, f32) {
    let offset = |at: u32, start: u32, length: u32| {
        (at as f32 + 0.5 - start as f32 - length as f32 / 2.0) / (length as f32 / 2.0)
    };
    (offset(x, region.x, region.width), offset(y, region.y, region.height))
}

/// The same as a radius: 1 on the inscribed ellipse.
fn face_radius(region: RectPx, x: u32, y: u32) -> f32 {
    let (dx, dy) = offsets(region, x, y);
    dx.hypot(dy)
}

fn place(region: RectPx, x: u32, y: u32) -> Place {
    let (dx, dy) = offsets(region, x, y);
    let outside_px = |d: f32, length: u32| (d.abs() - 1.0) * length as f32 / 2.0;
    if dx * dx + dy * dy <= 0.64 {
        Place::Middle
    } else if outside_px(dx, region.width).max(outside_px(dy, region.height)) > 1.0 {
        Place::Around
    } else {
        Place::Edge
    }
}

/// Takes lettering, inlays, borders and mixed edge pixels away: what stays is the colour that spans the object, its darker,
/// lighter and glossier tones, and other faces of some extent beside it. What lies inside belongs to the object by its
/// outline.
fn keep_shades(
    region: RectPx,
    labels: &[Option<usize>],
    colours: &[Cluster],
    tones: Tones,
) -> Vec<Option<usize>> {
    let object = labels.iter().flatten().count().max(1) as f32;
    let are_one = |main: usize, at: usize| tones.are_one(colours[main], colours[at]);
    let seen = |main: &usize| labels.contains(&Some(*main));
    // Of many shades one after the other is looked at, each in the memory of the one before.
    let (memory, mut scratch) = (Memory::new(), Memory::new());
    let merit = |main: usize| {
        scratch.reset();
        (main, Shade::of(&scratch, region, labels, |at| are_one(main, at)).merit())
    };
    let all = (0..colours.len()).filter(seen).map(merit);
    let Some((main, _)) = all.max_by(|a, b| a.1.total_cmp(&b.1)) else { return labels.to_vec() };
    let outline = Shade::of(&memory, region, labels, |at| are_one(main, at)).body.convex();
    let keep: Vec<bool> = (0..colours.len())
        .map(|at| {
            scratch.reset();
            let shade = Shade::of(&scratch, region, labels, |other| other == at);
            let large = shade.pixels as f32 >= MIN_SHARE * object;
            let tone = are_one(main, at) || same_shading(colours[main].mean, colours[at].mean);
            at == main || (large && (tone || (shade.is_solid() && !shade.lies_inside(&outline))))
        })
        .collect();
    labels.iter().map(|label| label.filter(|&shade| keep[shade])).collect()
}

/// Where one shade, or several as one, show in a region.
struct Shade<'m> {
    all: Patch<'m>,
    pixels: usize,
    /// Without specks and hair lines.
    body: Patch<'m>,
}

impl<'m> Shade<'m> {
    fn of(
        memory: &'m Memory,
        region: RectPx,
        labels: &[Option<usize>],
        is_one: impl Fn(usize) -> bool,
    ) -> Self {
        let all = Patch::from_fn(memory, region, |x, y| {
            labels[y as usize * region.width as usize + x as usize].is_some_and(&is_one)
        });
        Self { pixels: all.count(), body: all.opened(1), all }
    }

    /// How much the shade stands for the object: its pixels that are no mixtures with others, and the area that they
    /// span. A frame around lettering spans more than what it frames; a thin border spans more than that, but it is few
    /// pixels.
    fn merit(&self) -> f32 {
        let pure = self.all.eroded(1).count() as f32;
        let spanned = polygon_area_and_centroid(&self.body.hull()).map_or(0.0, |(area, _)| area);
        // Where nothing is pure the commonest must do.
        pure * spanned + 1e-6 * self.pixels as f32
    }

    /// Whether a good part of it lies far from its edge; that grows with the region, so strokes of lettering and borders
    /// are not solid at any scale.
    fn is_solid(&self) -> bool {
        let side = self.all.rect.width.min(self.all.rect.height) as i32;
        self.all.eroded((side / 14).max(1)).count() as f32 >= 0.3 * self.pixels as f32
    }

    fn lies_inside(&self, outline: &Patch<'_>) -> bool {
        let outside = self.body.without(outline).count() as f32;
        outside <= OUTSIDE_PART * self.body.count() as f32
    }
}

/// Whether `other` is `main` under more or less light: nearly proportional colours.
pub(super) fn same_shading(main: [f32; 3], other: [f32; 3]) -> bool {
    let gain = dot(main, other) / dot(main, main).max(1.0);
    let rest = (0..3).map(|c| (other[c] - gain * main[c]).powi(2)).sum::<f32>();
    (0.4..2.2).contains(&gain) && rest.sqrt() <= 18.0 * gain.max(1.0)
}

/// Whether two vivid colours are one under gloss or haze, which add some white: the same direction from grey, nearly as
/// far. What is farther is a mixture with something else.
fn same_tint(main: [f32; 3], other: [f32; 3]) -> bool {
    let tint = |color: [f32; 3]| color.map(|level| level - color.iter().sum::<f32>() / 3.0);
    let (main, other) = (tint(main), tint(other));
    let (length, other_length) = (dot(main, main).sqrt(), dot(other, other).sqrt());
    length >= LEAST_TINT
        && TINT_PART.contains(&(other_length / length))
        && dot(main, other) >= SAME_DIRECTION * length * other_length
}
