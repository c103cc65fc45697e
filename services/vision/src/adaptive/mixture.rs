//! The colours of a lettered sign under one light: its own colour, its lettering's, and every mixture of both.
//!
//! A camera mixes neighbours, so of a far sign hardly a pixel shows a colour of the descriptor. But all of them lie on the
//! line between two that it tells, which bushes and hills of nearly the tint do not.

use super::palette::{dot, minus};
use crate::landmark::ColorStats;

/// Colours further than this from all mixtures are not the sign's, levels,
const REACH: f32 = 24.0;
/// and so many standard deviations of the camera's noise more.
const NOISE_SIGMAS: f32 = 2.0;
/// What is lettering by more than this says nothing of a sign: clouds and walls are as light.
const MOST_LETTERED: f32 = 0.75;
/// Part of a face that lettering covers.
const LETTERED: (f32, f32) = (0.1, 0.9);

/// Both colours under the light of the descriptor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TwoColours {
    own: [f32; 3],
    /// What lettering changes of the sign's own colour, levels.
    legend: [f32; 3],
    /// Part of the face that it covers.
    part: f32,
}

impl TwoColours {
    /// Of a face that is lettering by a part p the mean differs from the sign's own colour by p of what lettering changes,
    /// and the variance is p (1 - p) of its square: both together tell p.
    pub(crate) fn of(own: [f32; 3], face: &ColorStats) -> Self {
        let off = minus(face.mean, own);
        let spread: f32 = face.variance.iter().sum();
        let part = (1.0 / (1.0 + spread / dot(off, off).max(1.0))).clamp(LETTERED.0, LETTERED.1);
        Self { own, legend: off.map(|level| level / part), part }
    }

    /// Both under a light of `gain` over the descriptor's.
    pub(crate) fn under(&self, gain: f32, noise_variance: [f32; 3]) -> Mixtures {
        let noise: f32 = noise_variance.iter().sum();
        let legend = self.legend.map(|level| gain * level);
        Mixtures {
            own: self.own.map(|level| gain * level),
            legend,
            inverse: 1.0 / dot(legend, legend).max(1.0),
            inverse_reach2: 1.0 / (REACH * REACH + NOISE_SIGMAS * NOISE_SIGMAS * noise),
        }
    }

    /// Part of the face that lettering covers.
    pub(crate) fn part(&self) -> f32 {
        self.part
    }

    /// Standard deviation of the part that is lettering, pixel by pixel, over a face that is resolved.
    pub(crate) fn spread(&self) -> f32 {
        (self.part * (1.0 - self.part)).sqrt()
    }

    /// The light under which a colour is a mixture, over the descriptor's: that of c = gain (own + p legend) for whichever
    /// p, by least squares.
    pub(crate) fn gain_of(&self, color: [f32; 3]) -> f32 {
        let (own2, legend2) = (dot(self.own, self.own), dot(self.legend, self.legend));
        let both = dot(self.own, self.legend);
        let determinant = (own2 * legend2 - both * both).max(1.0);
        (dot(color, self.own) * legend2 - dot(color, self.legend) * both) / determinant
    }
}

/// All mixtures under one light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mixtures {
    own: [f32; 3],
    legend: [f32; 3],
    inverse: f32,
    inverse_reach2: f32,
}

/// How a pixel compares with the mixtures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    /// How much it belongs to the sign, 0..1.
    pub(crate) belongs: f32,
    /// Part of it that is lettering.
    pub(crate) lettered: f32,
}

impl Mixtures {
    pub(crate) fn share(&self, pixel: [u8; 3]) -> Share {
        let from = minus(pixel.map(f32::from), self.own);
        let lettered = (dot(from, self.legend) * self.inverse).clamp(0.0, MOST_LETTERED);
        let off = minus(from, self.legend.map(|level| lettered * level));
        Share { belongs: (1.0 - dot(off, off) * self.inverse_reach2).max(0.0), lettered }
    }

    /// Which part of a pixel is lettering, however light that is; `None` of what is no mixture.
    pub(crate) fn lettered(&self, pixel: [u8; 3]) -> Option<f32> {
        let from = minus(pixel.map(f32::from), self.own);
        let lettered = dot(from, self.legend) * self.inverse;
        let off = minus(from, self.legend.map(|level| lettered * level));
        (dot(off, off) * self.inverse_reach2 < 1.0).then_some(lettered)
    }

    /// The sign's colour with that part of lettering, levels.
    pub(crate) fn mixed(&self, lettered: f32) -> [f32; 3] {
        std::array::from_fn(|c| (self.own[c] + lettered * self.legend[c]).clamp(0.0, 255.0))
    }
}
