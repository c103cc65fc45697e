//! Which colours may be the landmark's under the light of the moment.

use super::coarse::Coarse;
use super::face::{self, Face};
use super::memory::{CollectIn, List, Memory};
use super::palette::{dot, minus};
use super::patch::Judge;
use super::word::{self, WORD_PX};
use crate::landmark::{ColorStats, Landmark};

/// The mean tolerance is kept between these, levels: below, JPEG noise defeats it; above, everything matches.
const TOLERANCE: (f32, f32) = (14.0, 40.0);
/// How far the gain of the light may lie from the expected one in a full search, as a factor.
const FULL_SEARCH_GAIN: f32 = 1.45;
/// The same while an object is followed.
const FOLLOWED_GAIN: f32 = 1.22;

/// Under other light than the descriptor's a colour is known less well, since no camera is linear: this part of the
/// brightest channel for each unit by which the gain differs from 1.
const WIDENING: f32 = 0.12;

/// What stands before a surface of nearly its own colour is told from it within this part of the tolerances.
const STRICT: f32 = 0.6;

/// Less haze than this is left to the tolerances: what faces, shadows and lenses do to colours looks like a little, levels.
const COVERED_HAZE: f32 = 8.0;
/// So sure it is that there is no haze, in the squared length of what of white is not the shade: 1.2 of pure red, 0.03 of
/// cream.
const HAZE_PRIOR: f32 = 0.05;

/// A shade is vivid when its channels differ by this part of the largest.
const VIVID: f32 = 0.4;
/// Light on a face turned to it, over the most that a whole object gets.
const MOST_LIT: f32 = 1.4;
/// How far a lit face's colour may be off its shade's line through black, levels.
const LIT_SPREAD: f32 = 14.0;

/// The colours of a landmark's shades with more or less light on them: a slim cone around each shade's line through
/// black.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Likeness<'m> {
    cones: &'m [Cone],
    /// So many of them are asked whether a pixel matches.
    asked: usize,
    /// The face of a lettered sign as a whole, where the descriptor tells it.
    face: Option<Face>,
    /// How far the gain of the light may lie from the expected one, as a factor.
    gain_range: f32,
}

#[derive(Clone, Copy, Debug)]
struct Cone {
    shade: [f32; 3],
    /// White in it that the descriptor's shade has not, levels.
    haze: f32,
    /// Under the light of the descriptor.
    tolerance: [f32; 3],
    /// What is added to it for each unit by which the gain differs from 1.
    widening: f32,
    /// `shade / |shade|²`: the dot product with a colour is that colour's gain.
    onto_shade: [f32; 3],
    gain: (f32, f32),
}

/// The light on an object and what lies between it and the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Light {
    /// Brightness over the descriptor's.
    pub(crate) gain: f32,
    /// White that haze, gloss or the camera adds to the descriptor's colours, levels; negative where it is less than there.
    pub(crate) haze: f32,
}

impl Light {
    /// As it was when the descriptor was made.
    pub(crate) const AS_LEARNED: Self = Self { gain: 1.0, haze: 0.0 };
}

/// How a colour compares with the nearest shade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Match {
    /// Brightness over the shade's.
    pub(crate) gain: f32,
    /// The largest channel's distance from the shade under that gain, in tolerances.
    pub(crate) excess: f32,
}

impl<'m> Likeness<'m> {
    /// For a search of the whole frame, nothing known of the light but which is most likely.
    pub(crate) fn anywhere(
        memory: &'m Memory,
        landmark: &Landmark,
        light: Light,
        noise_variance: [f32; 3],
    ) -> Self {
        Self::new(memory, landmark, light, FULL_SEARCH_GAIN, noise_variance)
    }

    /// For an object that was last seen under `light`.
    pub(crate) fn followed(
        memory: &'m Memory,
        landmark: &Landmark,
        light: Light,
        noise_variance: [f32; 3],
    ) -> Self {
        Self::new(memory, landmark, light, FOLLOWED_GAIN, noise_variance)
    }

    fn new(
        memory: &'m Memory,
        landmark: &Landmark,
        light: Light,
        factor: f32,
        noise_variance: [f32; 3],
    ) -> Self {
        let far = face::far_view(landmark);
        let gain = light.gain;
        let haze = light.haze.signum() * (light.haze.abs() - COVERED_HAZE).max(0.0);
        let cone = |shade: &ColorStats| {
            let mean = shade.mean.map(|m| (m + haze).clamp(0.0, 255.0));
            let norm2 = mean.iter().map(|m| m * m).sum::<f32>().max(25.0);
            let tolerance = |c: usize| {
                let spread = 2.5 * (shade.variance[c].min(400.0) + noise_variance[c]).sqrt();
                landmark.tolerance.mean[c].max(spread).clamp(TOLERANCE.0, TOLERANCE.1)
            };
            Cone {
                shade: mean,
                haze,
                tolerance: std::array::from_fn(tolerance),
                widening: WIDENING * mean.iter().copied().fold(0.0, f32::max),
                onto_shade: mean.map(|m| m / norm2),
                gain: (gain / factor, gain * factor),
            }
        };
        let plain =
            landmark.shades.iter().enumerate().filter(|(at, _)| Some(*at) != far).map(|(_, shade)| shade);
        let cones: List<'m, Cone> = plain.map(cone).collect_in(memory);
        Self {
            asked: cones.len(),
            cones: cones.into_bump_slice(),
            face: far.and_then(|at| Face::of(landmark, at, gain)),
            gain_range: factor,
        }
    }

    /// The same, but tints paler than `palest` (a part of the pure shade's distance from grey) are not the landmark's.
    pub(crate) fn with_palest(&self, palest: f32) -> Self {
        let face = self.face.map(|face| face.with_palest(palest));
        Self { face, ..*self }
    }

    /// The same, but plain shades match within a part of their tolerances only.
    pub(crate) fn stricter<'k>(&self, memory: &'k Memory) -> Likeness<'k> {
        let strict = |cone: &Cone| Cone {
            tolerance: cone.tolerance.map(|tolerance| STRICT * tolerance),
            widening: STRICT * cone.widening,
            ..*cone
        };
        let cones = memory.alloc_slice_fill_iter(self.cones.iter().map(strict));
        Likeness { cones, ..*self }
    }

    /// The same, but only the tint says what matches.
    pub(crate) fn by_tint_alone(self) -> Self {
        Self { asked: 0, ..self }
    }

    /// The widest channel's tolerance under a light of `gain` over the descriptor's.
    pub(crate) fn tolerance_scale(&self, landmark: &Landmark, gain: f32) -> f32 {
        let given = landmark.tolerance.mean;
        let scale = |cone: &Cone| {
            let wider = cone.widening * (gain - 1.0).abs();
            (0..3).map(|c| (cone.tolerance[c] + wider) / given[c].max(1.0)).fold(0.0, f32::max)
        };
        self.cones.iter().map(scale).fold(0.0, f32::max)
    }

    /// Whether a pixel may be the landmark's.
    pub(crate) fn matches(&self, pixel: [u8; 3]) -> bool {
        let color = pixel.map(f32::from);
        self.face.is_some_and(|face| face.has_tint(color))
            || self.cones[..self.asked].iter().any(|cone| cone.holds(color))
    }

    /// For each of up to 64 pixels whether it may be the landmark's, the first in bit 0. The same as
    /// [`matches`](Self::matches), written so that compilers take many pixels at a time.
    #[inline(always)]
    pub(crate) fn matching(&self, rgb: &[u8]) -> u64 {
        let levels = word::split(rgb);
        let mut found = [0; WORD_PX];
        for cone in &self.cones[..self.asked] {
            for at in 0..WORD_PX {
                found[at] |= cone.holds([levels[0][at], levels[1][at], levels[2][at]]) as u8;
            }
        }
        if let Some(face) = &self.face {
            for at in 0..WORD_PX {
                found[at] |= face.has_tint([levels[0][at], levels[1][at], levels[2][at]]) as u8;
            }
        }
        word::packed(&found) & word::existing(rgb)
    }

    /// Makes `coarse` tell at a glance that no pixel of a run matches.
    pub(crate) fn enclose_in(&self, coarse: &mut Coarse) {
        let boxes = self.cones[..self.asked].iter().map(Cone::bounds);
        coarse.enclose(boxes, self.face.as_ref().map(Face::least_differences));
    }

    /// The means of the shades.
    pub(crate) fn shades(&self) -> impl Iterator<Item = [f32; 3]> + use<'m> {
        self.cones.iter().map(|cone| cone.shade)
    }

    /// The face of a lettered sign; `None` of other landmarks.
    pub(crate) fn face(&self) -> Option<&Face> {
        self.face.as_ref()
    }

    /// Whether next to nothing is known of the light.
    pub(crate) fn is_light_unknown(&self) -> bool {
        self.gain_range >= FULL_SEARCH_GAIN
    }

    /// White that a colour has more than the descriptor's nearest shade, levels.
    pub(crate) fn haze(&self, color: [f32; 3]) -> f32 {
        if let [only] = self.cones {
            return only.haze_of(color);
        }
        self.nearest_cone(color).map_or(0.0, |(cone, _)| cone.haze_of(color))
    }

    /// The comparison with the nearest shade.
    pub(crate) fn nearest(&self, color: [f32; 3]) -> Match {
        let nothing = Match { gain: 1.0, excess: f32::MAX };
        self.nearest_cone(color).map_or(nothing, |(_, compared)| compared)
    }

    fn nearest_cone(&self, color: [f32; 3]) -> Option<(&Cone, Match)> {
        let compared = self.cones.iter().map(|cone| (cone, cone.compare(color)));
        compared.min_by(|(_, a), (_, b)| a.excess.total_cmp(&b.excess))
    }
}

impl Judge for Likeness<'_> {
    #[inline(always)]
    fn wanted(&self, rgb: &[u8]) -> u64 {
        self.matching(rgb)
    }
}

/// Tells vivid shades' colours with more light on them than a whole object gets: faces turned to the light.
pub(crate) struct LitFaces<'a>(pub(crate) &'a Likeness<'a>);

impl Judge for LitFaces<'_> {
    #[inline(always)]
    fn wanted(&self, rgb: &[u8]) -> u64 {
        let levels = word::split(rgb);
        let mut found = [0; WORD_PX];
        for cone in self.0.cones {
            if cone.is_vivid() {
                for at in 0..WORD_PX {
                    found[at] |= cone.is_lit([levels[0][at], levels[1][at], levels[2][at]]) as u8;
                }
            }
        }
        word::packed(&found)
    }
}

impl Cone {
    fn compare(&self, color: [f32; 3]) -> Match {
        let gain = self.gain_of(color);
        let wider = self.widening * (gain - 1.0).abs();
        let off = |c: usize| (color[c] - gain * self.shade[c]).abs() / (self.tolerance[c] + wider);
        Match { gain, excess: off(0).max(off(1)).max(off(2)) }
    }

    /// White that a colour has more than the descriptor's shade, levels: by least squares along what of white is not the
    /// shade itself, with a prior of none. Of a shade near grey the two cannot be told apart.
    fn haze_of(&self, color: [f32; 3]) -> f32 {
        let gain = self.gain_of(color);
        let grey = dot(self.onto_shade, [1.0; 3]);
        let white = minus([1.0; 3], self.shade.map(|level| grey * level));
        let rest = minus(color, self.shade.map(|level| gain * level));
        let apart = dot(white, white);
        (self.haze * apart + dot(rest, white) / gain) / (apart + HAZE_PRIOR)
    }

    fn is_vivid(&self) -> bool {
        let spread = |(low, high): (f32, f32), level: f32| (low.min(level), high.max(level));
        let (least, most) = self.shade.iter().copied().fold((f32::MAX, 0.0), spread);
        most - least >= VIVID * most
    }

    /// Whether a colour is the shade's with more light on it than a whole object gets.
    #[inline(always)]
    fn is_lit(&self, color: [f32; 3]) -> bool {
        let [r, g, b] = self.onto_shade;
        let gain = color[0] * r + color[1] * g + color[2] * b;
        let off = [
            color[0] - gain * self.shade[0],
            color[1] - gain * self.shade[1],
            color[2] - gain * self.shade[2],
        ];
        let off2 = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
        (gain >= 1.0) & (gain < MOST_LIT * self.gain.1) & (off2 <= LIT_SPREAD * LIT_SPREAD)
    }

    /// Whether a colour lies in the cone.
    #[inline(always)]
    fn holds(&self, color: [f32; 3]) -> bool {
        let gain = self.gain_of(color);
        let wider = self.widening * (gain - 1.0).abs();
        let off = |c: usize| (color[c] - gain * self.shade[c]).abs() - wider;
        (off(0) <= self.tolerance[0]) & (off(1) <= self.tolerance[1]) & (off(2) <= self.tolerance[2])
    }

    /// The least and the greatest level of each channel within the cone.
    fn bounds(&self) -> [(f32, f32); 3] {
        // Both bounds are piecewise linear in the gain, with a corner at 1.
        let (low, high) = self.gain;
        let corners = [low, high, 1.0_f32.clamp(low, high)];
        std::array::from_fn(|c| {
            corners.iter().fold((f32::MAX, f32::MIN), |(least, most), gain| {
                let (level, reach) =
                    (gain * self.shade[c], self.tolerance[c] + self.widening * (gain - 1.0).abs());
                (least.min(level - reach), most.max(level + reach))
            })
        })
    }

    #[inline(always)]
    fn gain_of(&self, color: [f32; 3]) -> f32 {
        let [r, g, b] = self.onto_shade;
        let gain = color[0] * r + color[1] * g + color[2] * b;
        // Plainer than `f32::clamp`, so that compilers take many at a time.
        let gain = if gain > self.gain.0 { gain } else { self.gain.0 };
        if gain < self.gain.1 { gain } else { self.gain.1 }
    }
}
