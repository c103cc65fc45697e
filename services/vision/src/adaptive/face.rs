//! The face of a lettered sign as a whole.
//!
//! From afar lettering and border mix with the sign's colour: no pixel shows a shade of its own, but the tint stays,
//! the mean over the face stays, and where the face is pale it is light. A plain object of the sign's colour has
//! another mean, and its pale pixels, which are mixtures with what stands around it, are no lighter than the others.

use super::likeness::Match;
use super::mixture::TwoColours;
use super::palette::dot;
use crate::landmark::{ColorStats, Landmark};

/// How far a channel of the face's mean may be off, levels: lettering is never resolved twice in the same way.
const TOLERANCE: f32 = 22.0;
/// How far the gain may lie from the expected one, as a factor: haze and blur darken and lighten small signs.
const GAIN_RANGE: f32 = 1.7;
/// Part of the pure shade's distance from grey below which a pixel does not show the tint.
const PALEST: f32 = 0.3;
const DEEPEST: f32 = 1.5;
/// How far a tint may point aside, as a part of its length and in levels.
const TINT_SPREAD: f32 = 0.25;
const TINT_NOISE: f32 = 5.0;
/// The middle of a face reaches to this part of its radius.
const MIDDLE_RADIUS: f32 = 0.45;
/// Brightness of lettering over the brightest channel of the sign's colour.
pub(crate) const LETTERING_BRIGHTNESS: f32 = 1.3;

/// The pairs of channels whose differences are bounded.
pub(crate) const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];

/// What is known of a sign's face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    mean: [f32; 3],
    /// The expected gain of the light.
    gain: f32,
    /// From grey to the sign's colour, of length 1.
    tint: [f32; 3],
    /// Distance of the sign's colour from grey, levels.
    purity: f32,
    palest: f32,
    /// Brightness of the sign's colour over the face's.
    plainness: f32,
    /// How much lighter than the sign's colour lettering is, levels.
    lighter: f32,
    /// How much paleness and brightness go together on a clear face, levels².
    lettering: f32,
    colours: TwoColours,
}

/// How an object as a whole compares with the face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaceMatch {
    pub(crate) color: Match,
    /// How much its pale pixels are lighter, as a part of what a clear face shows; 0 or less of a plain object.
    pub(crate) lettering: f32,
}

impl Face {
    /// The face told by shade number `far` of a sign; `None` where the sign has no tint.
    pub(crate) fn of(landmark: &Landmark, far: usize, gain: f32) -> Option<Self> {
        let own = landmark.shades.iter().enumerate().find(|(at, _)| *at != far)?.1.mean;
        let mean = landmark.shades[far].mean;
        let away = away_from_grey(own);
        let purity = dot(away, away).sqrt();
        let white = (LETTERING_BRIGHTNESS * own.iter().copied().fold(0.0, f32::max)).min(255.0);
        let lighter = white - brightness(own);
        let lettered = ((brightness(mean) - brightness(own)) / lighter).clamp(0.05, 0.5);
        (purity >= 20.0 && lighter > 0.0).then(|| Self {
            mean,
            gain,
            tint: away.map(|level| level / purity),
            purity,
            palest: PALEST,
            plainness: brightness(own) / brightness(mean).max(1.0),
            lighter,
            lettering: lettered * (1.0 - lettered) * lighter * purity,
            colours: TwoColours::of(own, &landmark.shades[far]),
        })
    }

    /// The sign's colour and its lettering's.
    pub(crate) fn colours(&self) -> &TwoColours {
        &self.colours
    }

    /// How much lighter than the sign's colour lettering is under the expected light, levels.
    pub(crate) fn lighter(&self) -> f32 {
        self.lighter * self.gain
    }

    pub(crate) fn with_palest(self, palest: f32) -> Self {
        Self { palest, ..self }
    }

    /// Whether a colour shows the tint, pale or deep.
    #[inline(always)]
    pub(crate) fn has_tint(&self, color: [f32; 3]) -> bool {
        let away = away_from_grey(color);
        let along = dot(away, self.tint);
        let aside2 = dot(away, away) - along * along;
        let purity = along / self.purity;
        let spread = TINT_SPREAD * along + TINT_NOISE;
        (purity >= self.palest) & (purity < DEEPEST) & (aside2 <= spread * spread)
    }

    /// By how much the first channel exceeds the second, at least, in every colour that shows the tint: for R−G, R−B,
    /// G−R, G−B, B−R and B−G, levels.
    pub(crate) fn least_differences(&self) -> [f32; 6] {
        PAIRS.map(|(a, b)| {
            // What points aside by d moves a difference of two channels by √2 d at most.
            let slope = self.tint[a] - self.tint[b] - std::f32::consts::SQRT_2 * TINT_SPREAD;
            let along = self.purity * if slope > 0.0 { self.palest } else { DEEPEST };
            along * slope - std::f32::consts::SQRT_2 * TINT_NOISE
        })
    }

    /// How much of the tint a colour shows, 1 for the pure colour.
    pub(crate) fn tint_of(&self, color: [f32; 3]) -> f32 {
        let away = away_from_grey(color);
        let along = dot(away, self.tint);
        let aside = (dot(away, away) - along * along).max(0.0).sqrt();
        ((along - aside) / self.purity).clamp(0.0, 1.2)
    }

    /// How pale the middle of an object is against the ring around it, as a part of the pure saturation: lettering
    /// shows there even where it cannot be resolved, and a plain object is palest at its edge.
    pub(crate) fn pale_middle(&self, pixels: impl Iterator<Item = ([f32; 3], f32)>) -> f32 {
        let (mut middle, mut ring) = ((0.0_f32, 0.0_f32), (0.0_f32, 0.0_f32));
        for (color, radius) in pixels {
            let saturation = dot(away_from_grey(color), self.tint) / brightness(color).max(16.0);
            let part = if radius < MIDDLE_RADIUS { &mut middle } else { &mut ring };
            part.0 += saturation;
            part.1 += 1.0;
        }
        let pure = self.purity / (brightness(self.mean) * self.plainness).max(16.0);
        (ring.0 / ring.1.max(1.0) - middle.0 / middle.1.max(1.0)) / pure
    }

    /// The comparison of an object's pixels with the face.
    pub(crate) fn compare(&self, pixels: impl Iterator<Item = [f32; 3]>) -> FaceMatch {
        let (mut n, mut sum, mut light, mut pure, mut both) = (0.0_f32, [0.0_f32; 3], 0.0, 0.0, 0.0);
        for color in pixels {
            let (bright, tinted) = (brightness(color), dot(away_from_grey(color), self.tint));
            n += 1.0;
            light += bright;
            pure += tinted;
            both += bright * tinted;
            sum.iter_mut().zip(color).for_each(|(total, level)| *total += level);
        }
        let n = n.max(1.0);
        let color = self.compare_mean(sum.map(|total| total / n));
        let together = both / n - light / n * pure / n;
        FaceMatch { color, lettering: -together / (self.lettering * color.gain * color.gain) }
    }

    fn compare_mean(&self, color: [f32; 3]) -> Match {
        let gain = dot(color, self.mean) / dot(self.mean, self.mean);
        let gain = gain.clamp(self.gain / GAIN_RANGE, self.gain * GAIN_RANGE);
        let off = (0..3).map(|c| (color[c] - gain * self.mean[c]).abs() / (TOLERANCE * gain.max(0.6)));
        Match { gain, excess: off.fold(0.0, f32::max) }
    }
}

/// Which of a sign's shades is its whole face with lettering and border: one whose variance is far above the
/// plainest shade's.
pub(crate) fn far_view(landmark: &Landmark) -> Option<usize> {
    let total = |shade: &ColorStats| shade.variance.iter().sum::<f32>();
    let plainest = landmark.shades.iter().map(total).fold(f32::MAX, f32::min);
    let busy = |shade: &ColorStats| total(shade) > 1500.0 && total(shade) > 6.0 * plainest;
    let several = landmark.shape.is_sign() && landmark.shades.len() > 1;
    several.then(|| landmark.shades.iter().rposition(busy)).flatten()
}

#[inline(always)]
fn brightness(color: [f32; 3]) -> f32 {
    (color[0] + color[1] + color[2]) / 3.0
}

#[inline(always)]
fn away_from_grey(color: [f32; 3]) -> [f32; 3] {
    let grey = brightness(color);
    color.map(|level| level - grey)
}
