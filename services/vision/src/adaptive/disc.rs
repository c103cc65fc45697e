//! Round signs too small to show an outline: the disc that stands out most by its tint.
//!
//! A few pixels across, a sign's outline melts into whatever stands next to it, and a mask of its tint takes in posts
//! and bushes. A disc whose inside shows the tint and whose surroundings do not, on all sides, is the better model.

use super::face::Face;
use super::memory::{List, Memory};
use super::patch::Patch;
use crate::frame::Frame;
use crate::geometry::{PointPx, RectPx};

/// Radii tried, px.
const RADII_PX: (f32, f32) = (3.0, 9.0);
const RADIUS_STEP: f32 = 1.09;
/// A plain object before something dark has a middle that is lighter than its edge by up to this.
const EDGE_ALONE: f32 = 0.12;
/// The middle of a disc reaches to this part of its radius.
const MIDDLE_RADIUS: f32 = 0.5;
/// Steps from the best coarse disc to the best one near it.
const MOST_STEPS: u32 = 8;
/// Directions in which the surroundings are judged.
const SECTORS: usize = 8;

/// A disc and how it stands out.
#[derive(Clone, Copy, Debug)]
struct Disc {
    x: f32,
    y: f32,
    radius: f32,
}

/// How a disc stands out from its surroundings.
#[derive(Clone, Copy, Debug, Default)]
struct Contrast {
    /// Tint inside less tint around, as a part of the pure tint.
    overall: f32,
    /// The same in the second weakest direction, as a part of the tint inside.
    weakest: f32,
    /// How much lighter the middle is than the ring around it, as a part of what lettering is lighter than the sign.
    light_middle: f32,
}

/// What the factors of [`Contrast::merit`] but the tint and the size come to at most.
const MOST_MERIT: f32 = 1.0;

impl Contrast {
    fn merit(&self, disc: Disc) -> f32 {
        let on_all_sides = 0.5 + 0.5 * self.weakest.max(0.0);
        let lettered = 0.4 + self.light_middle.clamp(-0.2, 0.6);
        self.overall * on_all_sides * lettered * disc.radius.powf(0.6)
    }
}

/// A disc that stands out.
pub(crate) struct Found<'s> {
    pub(crate) centre: PointPx,
    pub(crate) mask: Patch<'s>,
    /// How clearly it stands out on its weaker sides, 0..1.
    pub(crate) clear: f32,
    /// How much lighter its middle is, as a part of what a clear face shows.
    pub(crate) lettering: f32,
}

/// The most outstanding disc centred within `bounds` of the frame, as a mask of the pixels of `rect`.
pub(crate) fn find<'s>(
    memory: &'s Memory,
    frame: &Frame,
    rect: RectPx,
    bounds: RectPx,
    face: &Face,
) -> Option<Found<'s>> {
    let tints = Tints::of(memory, frame, rect, face);
    let (left, top) = ((bounds.x - rect.x) as f32, (bounds.y - rect.y) as f32);
    let mut best = Best::default();
    let largest = RADII_PX.1.min(0.75 * bounds.width.max(bounds.height) as f32 + 1.0);
    // Every other radius at every whole pixel, then all around the best of those.
    let mut radius = RADII_PX.0;
    while radius <= largest {
        for v in 0..=bounds.height {
            for u in 0..=bounds.width {
                best.try_disc(&tints, Disc { x: left + u as f32, y: top + v as f32, radius });
            }
        }
        radius *= RADIUS_STEP * RADIUS_STEP;
    }
    for step_px in [0.5, 0.25] {
        for _ in 0..MOST_STEPS {
            let (from, merit) = (best.found?.0, best.merit);
            best.try_around(&tints, from, step_px);
            if best.merit <= merit {
                break;
            }
        }
    }
    let (disc, contrast) = best.found?;
    (contrast.overall > 0.15).then(|| Found {
        centre: PointPx::new(rect.x as f32 + disc.x, rect.y as f32 + disc.y),
        mask: disc.patch(memory, rect),
        clear: contrast.weakest.clamp(0.0, 1.0),
        lettering: contrast.light_middle - EDGE_ALONE,
    })
}

/// The disc that stands out most of those tried.
#[derive(Default)]
struct Best {
    merit: f32,
    found: Option<(Disc, Contrast)>,
}

impl Best {
    fn try_around(&mut self, tints: &Tints<'_>, disc: Disc, step_px: f32) {
        for scale in [1.0 / RADIUS_STEP.powf(2.0 * step_px), 1.0, RADIUS_STEP.powf(2.0 * step_px)] {
            for v in -1..=1 {
                for u in -1..=1 {
                    let (x, y) = (disc.x + step_px * u as f32, disc.y + step_px * v as f32);
                    self.try_disc(tints, Disc { x, y, radius: disc.radius * scale });
                }
            }
        }
    }

    fn try_disc(&mut self, tints: &Tints<'_>, disc: Disc) {
        // Nothing around it can make a disc stand out more than its own tint.
        if self.found.is_some()
            && MOST_MERIT * (tints.inside(disc) + 0.05) * disc.radius.powf(0.6) <= self.merit
        {
            return;
        }
        let contrast = tints.contrast(disc);
        let merit = contrast.merit(disc);
        if self.found.is_none() || merit > self.merit {
            (self.merit, self.found) = (merit, Some((disc, contrast)));
        }
    }
}

impl Disc {
    fn patch(self, memory: &Memory, rect: RectPx) -> Patch<'_> {
        Patch::from_fn(memory, rect, |x, y| {
            (x as f32 + 0.5 - self.x).powi(2) + (y as f32 + 0.5 - self.y).powi(2) <= self.radius * self.radius
        })
    }
}

/// How much of the tint each pixel of a rectangle shows, 1 for the pure colour.
struct Tints<'s> {
    width: i32,
    height: i32,
    /// Tint and brightness of each pixel.
    values: List<'s, (f32, f32)>,
    /// For each row the sums of the tints left of each column.
    sums: List<'s, f32>,
    /// How much lighter than the sign's colour lettering is, levels.
    lighter: f32,
}

impl<'s> Tints<'s> {
    fn of(memory: &'s Memory, frame: &Frame, rect: RectPx, face: &Face) -> Self {
        let rows = rect.y..rect.y + rect.height;
        let tint = |x: u32, y: u32| {
            let color = frame.pixel(x, y).map(f32::from);
            (face.tint_of(color), (color[0] + color[1] + color[2]) / 3.0)
        };
        let mut values = List::with_capacity_in((rect.width * rect.height) as usize, memory);
        values.extend(rows.flat_map(|y| (rect.x..rect.x + rect.width).map(move |x| tint(x, y))));
        let mut sums = List::with_capacity_in(values.len() + rect.height as usize, memory);
        for row in values.chunks_exact(rect.width as usize) {
            sums.push(0.0);
            sums.extend(row.iter().scan(0.0, |sum, (tint, _)| {
                *sum += tint;
                Some(*sum)
            }));
        }
        Self { width: rect.width as i32, height: rect.height as i32, values, sums, lighter: face.lighter() }
    }

    /// Mean tint of the pixels whose centres lie in a disc.
    fn inside(&self, disc: Disc) -> f32 {
        let (mut sum, mut n) = (0.0, 0);
        let rows = (disc.y - disc.radius) as i32..(disc.y + disc.radius) as i32 + 1;
        for y in rows.start.max(0)..rows.end.min(self.height) {
            let half2 = disc.radius * disc.radius - (y as f32 + 0.5 - disc.y).powi(2);
            if half2 < 0.0 {
                continue;
            }
            let half = half2.sqrt();
            let start = ((disc.x - half - 0.5).ceil() as i32).clamp(0, self.width);
            let end = ((disc.x + half - 0.5).floor() as i32 + 1).clamp(start, self.width);
            let row = &self.sums[(y * (self.width + 1)) as usize..];
            sum += row[end as usize] - row[start as usize];
            n += end - start;
        }
        sum / n.max(1) as f32
    }

    fn contrast(&self, disc: Disc) -> Contrast {
        let reach = 1.45 * disc.radius + 1.0;
        let (inner2, near2, far2) = (disc.radius.powi(2), (disc.radius + 0.7).powi(2), reach * reach);
        let (mut inside, mut inside_n) = (0.0_f32, 0.0_f32);
        let (mut middle, mut ring) = ((0.0_f32, 0.0_f32), (0.0_f32, 0.0_f32));
        let soft2 = (disc.radius + 0.5).powi(2);
        let middle2 = inner2 * MIDDLE_RADIUS * MIDDLE_RADIUS;
        let mut around = [(0.0_f32, 0.0_f32); SECTORS];
        for y in ((disc.y - reach) as i32).max(0)..((disc.y + reach) as i32 + 1).min(self.height) {
            for x in ((disc.x - reach) as i32).max(0)..((disc.x + reach) as i32 + 1).min(self.width) {
                let (dx, dy) = (x as f32 + 0.5 - disc.x, y as f32 + 0.5 - disc.y);
                let distance2 = dx * dx + dy * dy;
                let (tint, light) = self.values[(y * self.width + x) as usize];
                if distance2 <= soft2 {
                    // Pixels on the edge count by the part of them that the disc covers.
                    let covered = (disc.radius + 0.5 - distance2.sqrt()).clamp(0.0, 1.0);
                    inside += covered * tint;
                    inside_n += covered;
                }
                if distance2 <= inner2 {
                    let part = if distance2 <= middle2 { &mut middle } else { &mut ring };
                    *part = (part.0 + light, part.1 + 1.0);
                } else if (near2..far2).contains(&distance2) {
                    let (sum, n) = &mut around[sector(dx, dy)];
                    *sum += tint;
                    *n += 1.0;
                }
            }
        }
        let inside = inside / inside_n.max(1.0);
        let total = around.iter().fold((0.0, 0.0), |(sum, n), (s, k)| (sum + s, n + k));
        let mut sides = around.map(|(sum, n)| (inside - sum / n.max(1.0)) / inside.max(0.05));
        sides.sort_by(f32::total_cmp);
        let mean = |(sum, n): (f32, f32)| sum / n.max(1.0);
        let light_middle = (mean(middle) - mean(ring)) / self.lighter;
        Contrast { overall: inside - mean(total), weakest: sides[1], light_middle }
    }
}

/// Which of eight directions (0: right to below right, onwards clockwise).
fn sector(dx: f32, dy: f32) -> usize {
    let steep = usize::from(dy.abs() > dx.abs());
    match (dx >= 0.0, dy >= 0.0) {
        (true, true) => steep,
        (false, true) => 3 - steep,
        (false, false) => 4 + steep,
        (true, false) => 7 - steep,
    }
}
