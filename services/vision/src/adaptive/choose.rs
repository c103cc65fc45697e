//! How much an object looks like the landmark: colour, texture, light, size, form and what surrounds it.

use super::candidate::Search;
use super::memory::{CollectIn, List};
use super::patch::{Patch, enclosing_rectangle_area, polygon_area_and_centroid};
use crate::geometry::PointPx;
use crate::landmark::{ColorStats, ShapeClass};

/// An object of this area is as likely a speck as a landmark, px².
const SPECK_AREA_PX2: f32 = 24.0;
/// Part of a sign's own variance at which an object is as likely plain as lettered.
const PLAIN_FACE: f32 = 0.12;
/// Faces are judged by more evidence than plain objects; this brings both to one scale.
const FACE_SCALE: f32 = 0.65;
/// Lettering of smaller signs is a smear, px².
const RESOLVED_AREA_PX2: f32 = 110.0;
/// A rectangle, far away and askew, fills this much of the smallest one around it.
const FULL_RECTANGLE: f32 = 0.84;
/// Of an octagon, a disc or what blur makes of them, the hull is at least this round
const ROUND: f32 = 0.90;
/// and fills at most this much of the smallest rectangle around it.
const FULL_ROUND: f32 = 0.88;
/// What is smaller shows no outline, px²: a disc that is fitted to its tint tells more than the pixels of its mask.
const OUTLINE_AREA_PX2: f32 = 100.0;
/// How much less a mask of that size says.
const UNFITTED: f32 = 0.75;
/// A fitted disc and the pixels it was fitted to have this part of their union in common,
const FITTING: f32 = 0.38;
/// and this part where it is one more beside others that are known: a disc of its tint can be fitted across any red kerb.
const FITTING_WELL: f32 = 0.6;
/// Lettering of a sign of so many blurs across is a smear, and of so many is clear.
const SMEARED: f32 = 8.0;
const CLEAR: f32 = 14.0;
/// A plain object too small for its blur has a middle deeper than its ring by about this, a sign has not.
const PLAIN_SMEAR: f32 = 0.2;

/// The form of an object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    /// Area over the area of the convex hull, 0..1.
    pub(crate) solidity: f32,
    /// Long over short axis of the ellipse of the same moments, at least 1.
    pub(crate) elongation: f32,
    /// Area of the convex hull over the area of the smallest rectangle around it, 0..1: 0.79 of a disc.
    pub(crate) fullness: f32,
    /// 4πA/P² of the convex hull, 0..1: 0.95 of an octagon, 0.79 of a square.
    pub(crate) roundness: f32,
    /// Of a disc that was fitted to pixels: what both have in common as a part of what they cover together.
    pub(crate) fitted: Option<f32>,
    /// Evidence of lettering that its form gave, as a part of a clear face's.
    pub(crate) lettering: f32,
}

impl Form {
    /// Of a disc.
    pub(crate) const ROUND: Self = Self {
        solidity: 1.0,
        elongation: 1.0,
        fullness: std::f32::consts::FRAC_PI_4,
        roundness: 1.0,
        fitted: None,
        lettering: 0.0,
    };

    pub(crate) fn of(object: &Patch<'_>) -> Self {
        let area = object.count() as f32;
        let hull = object.hull();
        let hull_area = polygon_area_and_centroid(&hull).map_or(area, |(hull_area, _)| hull_area);
        Self {
            solidity: (area / hull_area.max(1.0)).min(1.0),
            elongation: elongation(object),
            fullness: (hull_area / enclosing_rectangle_area(&hull).max(1.0)).min(1.0),
            roundness: roundness(&hull, hull_area),
            fitted: None,
            lettering: 0.0,
        }
    }

    /// How well it suits a shape class whatever the details of its outline, 0..1.
    fn suits(&self, shape: ShapeClass) -> f32 {
        let longest = match shape {
            ShapeClass::Octagon | ShapeClass::Circle => 1.35,
            ShapeClass::Block | ShapeClass::Triangle => 1.7,
            ShapeClass::Rectangle => 6.0,
            ShapeClass::Any => 4.0,
        };
        let too_long = (self.elongation / longest).max(1.0) - 1.0;
        (-(too_long / 0.25).powi(2)).exp() * self.suits_if_covered(shape)
    }

    /// How well it can be a lettered sign that is round, 0..1.
    fn suits_round(&self, area_px2: f32, least_fitting: f32) -> f32 {
        let Some(fitted) = self.fitted else {
            let (angular, full) = ((ROUND - self.roundness).max(0.0), (self.fullness - FULL_ROUND).max(0.0));
            let outline = (-(angular / 0.05).powi(2) - (full / 0.06).powi(2)).exp();
            return if area_px2 < OUTLINE_AREA_PX2 { UNFITTED * outline } else { outline };
        };
        (-((least_fitting - fitted).max(0.0) / 0.15).powi(2)).exp()
    }

    /// The same if something may cover a part of it: what is left of a convex form has any length, but is convex.
    fn suits_if_covered(&self, shape: ShapeClass) -> f32 {
        let least_solid = if shape == ShapeClass::Block { 0.8 } else { 0.6 };
        let too_ragged = (least_solid - self.solidity).max(0.0);
        let least_full = if shape == ShapeClass::Rectangle { FULL_RECTANGLE } else { 0.0 };
        let too_round = (least_full - self.fullness).max(0.0);
        (-(too_ragged / 0.15).powi(2) - (too_round / 0.06).powi(2)).exp()
    }
}

/// 4πA/P² of a polygon.
fn roundness(hull: &[PointPx], area_px2: f32) -> f32 {
    let sides = hull.iter().zip(hull.iter().cycle().skip(1));
    let perimeter_px: f32 = sides.map(|(from, to)| from.distance_px(*to)).sum();
    (4.0 * std::f32::consts::PI * area_px2 / perimeter_px.powi(2).max(1.0)).min(1.0)
}

fn elongation(object: &Patch<'_>) -> f32 {
    // Sums of whole numbers up to an end, of which differences are sums over a run.
    let firsts = |end: u64| end * end.saturating_sub(1) / 2;
    let squares = |end: u64| firsts(end) * (2 * end).saturating_sub(1) / 3;
    let (mut n, mut sx, mut sy, mut xx, mut xy, mut yy) = (0, 0, 0, 0, 0, 0);
    object.each_run(|run| {
        let (start, end, y) = (u64::from(run.x_start), u64::from(run.x_end), u64::from(run.y));
        let (pixels, columns) = (end - start, firsts(end) - firsts(start));
        n += pixels;
        sx += columns;
        sy += pixels * y;
        xx += squares(end) - squares(start);
        xy += columns * y;
        yy += pixels * y * y;
    });
    let [n, sx, sy, xx, xy, yy] = [n, sx, sy, xx, xy, yy].map(|sum| sum as f64);
    // One twelfth is the second moment of a pixel itself.
    let (xx, yy, xy) = (
        xx / n - (sx / n).powi(2) + 1.0 / 12.0,
        yy / n - (sy / n).powi(2) + 1.0 / 12.0,
        xy / n - sx * sy / n / n,
    );
    let (half, root) = ((xx + yy) / 2.0, (((xx - yy) / 2.0).powi(2) + xy * xy).sqrt());
    ((half + root) / (half - root).max(1e-3)).sqrt() as f32
}

/// How much an object looks like the landmark, 0..1 each, 1 where nothing speaks against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factors {
    /// Specks are as likely anything.
    pub(crate) size: f32,
    /// What surrounds it looks otherwise.
    pub(crate) isolation: f32,
    /// The light on it is the expected one.
    pub(crate) light: f32,
    /// Its colour under that light is the landmark's.
    pub(crate) colour: f32,
    /// It is as plain, or as lettered, as the landmark is.
    pub(crate) texture: f32,
    /// The same where what cannot be seen counts as missing.
    pub(crate) texture_shown: f32,
    /// Its form suits the shape class.
    pub(crate) form: f32,
    /// The same where that must be seen clearly.
    pub(crate) form_shown: f32,
    /// The same if something may cover a part of it.
    pub(crate) form_if_covered: f32,
    /// Brings different kinds of landmarks to one scale: the exponent of the product.
    scale: f32,
}

impl Factors {
    /// When all of it is in view.
    pub(crate) fn whole(&self) -> f32 {
        (self.surely() * self.form).powf(self.scale)
    }

    /// When something may cover a part of it.
    pub(crate) fn covered(&self) -> f32 {
        (self.surely() * self.form_if_covered).powf(self.scale)
    }

    /// When it is one object more beside others that are known: that needs to be seen.
    pub(crate) fn further(&self) -> f32 {
        Self { texture: self.texture_shown, form: self.form_shown, ..*self }.whole()
    }

    fn surely(&self) -> f32 {
        self.size * self.isolation * self.light * self.colour * self.texture
    }
}

/// How much the object looks like the landmark.
pub(crate) fn factors(
    search: &Search<'_>,
    object: &Patch<'_>,
    form: &Form,
    area_px2: f32,
    observed: &ColorStats,
) -> Factors {
    let off = |value: f32, sigma: f32| (-0.5 * (value / sigma).powi(2)).exp();
    let shape = search.landmark.shape;
    let plain = Factors {
        size: area_px2 / (area_px2 + SPECK_AREA_PX2),
        isolation: isolation(search, object),
        light: 1.0,
        colour: 1.0,
        texture: 1.0,
        texture_shown: 1.0,
        form: form.suits(shape),
        form_shown: form.suits(shape),
        form_if_covered: form.suits_if_covered(shape),
        scale: 1.0,
    };
    if let Some(face) = search.likeness.face() {
        let pixels = face_pixels(search, object);
        let seen = face.compare(pixels.iter().map(|(color, _)| *color));
        let pale = face.pale_middle(pixels.iter().copied());
        let round = |least_fitting: f32| {
            if shape.is_round() { form.suits_round(area_px2, least_fitting) } else { 1.0 }
        };
        let resolved = resolved(search, area_px2);
        let (lettering, sigma) =
            if area_px2 >= RESOLVED_AREA_PX2 { (resolved * seen.lettering, 1.0) } else { (0.0, 1.5) };
        let evidence = lettering.max(pale).max(form.lettering).max(0.0);
        let lettered = (evidence * (1.0 + PLAIN_FACE) / (evidence + PLAIN_FACE)).min(1.0);
        // What cannot be seen speaks neither for nor against it; that a middle is deep can be seen for longer.
        let smear = if form.fitted.is_some() { pale.max(form.lettering) } else { pale };
        let unresolved = lettered.max((1.0 + (smear + 0.02) / PLAIN_SMEAR).clamp(0.3, 1.0));
        Factors {
            light: off((seen.color.gain / search.light.gain).max(1e-3).ln(), 0.4),
            colour: off(seen.color.excess, sigma),
            texture_shown: lettered,
            texture: resolved * lettered + (1.0 - resolved) * unresolved,
            // Half a bush is as likely as half a sign, which shows only half of what is written on it.
            form: plain.form * round(FITTING),
            form_shown: plain.form * round(FITTING_WELL),
            form_if_covered: plain.form * round(FITTING),
            scale: FACE_SCALE,
            ..plain
        }
    } else {
        let color = search.likeness.nearest(observed.mean);
        let texture = off(variance_excess(search, observed), 3.0);
        Factors {
            light: off((color.gain / search.light.gain).max(1e-3).ln(), 0.25),
            colour: off(color.excess, 0.7),
            texture,
            texture_shown: texture,
            ..plain
        }
    }
}

/// How much of a sign's lettering can be seen through the frame's blur, 0..1.
fn resolved(search: &Search<'_>, area_px2: f32) -> f32 {
    // Nothing but its lettering tells a far rectangle from half a bush.
    if !search.landmark.shape.is_round() {
        return 1.0;
    }
    let diameter_px = (4.0 * area_px2 / std::f32::consts::PI).sqrt();
    ((diameter_px / search.blur_px - SMEARED) / (CLEAR - SMEARED)).clamp(0.0, 1.0)
}

/// A pixel of an object and its distance from the middle as a part of the radius.
type FacePixel = ([f32; 3], f32);

/// The pixels of an object without its edge.
fn face_pixels<'s>(search: &Search<'_>, object: &Patch<'s>) -> List<'s, FacePixel> {
    let inner = object.eroded(1);
    let inner = if inner.count() >= 9 { &inner } else { object };
    let (mut n, mut sx, mut sy) = (0.0_f32, 0.0_f32, 0.0_f32);
    for (x, y) in inner.set_places() {
        (n, sx, sy) = (n + 1.0, sx + x as f32, sy + y as f32);
    }
    let (mx, my, radius) = (sx / n, sy / n, (object.count() as f32 / std::f32::consts::PI).sqrt());
    let pixel = |(x, y): (i32, i32)| {
        let pixel = search.frame.pixel(object.rect.x + x as u32, object.rect.y + y as u32);
        (pixel.map(f32::from), (x as f32 - mx).hypot(y as f32 - my) / radius)
    };
    inner.set_places().map(pixel).collect_in(object.memory())
}

/// By how many tolerances the observed variance exceeds the descriptor's, camera noise taken out.
pub(super) fn variance_excess(search: &Search<'_>, observed: &ColorStats) -> f32 {
    let over = |shade: &ColorStats, c: usize| {
        let tolerance = search.landmark.tolerance.variance[c].max(50.0);
        ((observed.variance[c] - search.noise_variance[c] - shade.variance[c]).max(0.0) / tolerance - 1.0)
            .max(0.0)
    };
    let worst = |shade: &ColorStats| (0..3).map(|c| over(shade, c)).fold(0.0, f32::max);
    search.landmark.shades.iter().map(worst).fold(f32::MAX, f32::min)
}

/// The part of a ring around the object that does not look like the landmark: low inside something larger.
fn isolation(search: &Search<'_>, object: &Patch<'_>) -> f32 {
    let inner = object.dilated(2);
    let ring = inner.dilated(2).without(&inner);
    let like = ring.judged(search.frame, &search.likeness).count() as f32;
    let all = ring.count() as f32;
    if all == 0.0 { 1.0 } else { 1.0 - like / all }
}
