//! Which colours may be the landmark's under the light of the moment.

use super::face::{self, Face};
use crate::landmark::{ColorStats, Landmark};

/// The mean tolerance is kept between these, levels: below, JPEG noise defeats it; above, everything matches.
const TOLERANCE: (f32, f32) = (14.0, 40.0);
/// How far the gain of the light may lie from the expected one in a full search, as a factor.
const FULL_SEARCH_GAIN: f32 = 1.45;
/// The same while an object is followed.
const FOLLOWED_GAIN: f32 = 1.22;

/// The colours of a landmark's shades with more or less light on them: a slim cone around each shade's line through
/// black.
#[derive(Clone, Debug)]
pub(crate) struct Likeness {
    cones: Vec<Cone>,
    /// The face of a lettered sign as a whole, where the descriptor tells it.
    face: Option<Face>,
}

#[derive(Clone, Copy, Debug)]
struct Cone {
    shade: [f32; 3],
    tolerance: [f32; 3],
    /// `shade / |shade|²`: the dot product with a colour is that colour's gain.
    onto_shade: [f32; 3],
    gain: (f32, f32),
}

/// How a colour compares with the nearest shade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Match {
    /// Brightness over the shade's.
    pub(crate) gain: f32,
    /// The largest channel's distance from the shade under that gain, in tolerances.
    pub(crate) excess: f32,
}

impl Likeness {
    /// For a search of the whole frame, nothing known of the light but `gain`, its most likely value.
    pub(crate) fn anywhere(landmark: &Landmark, gain: f32, noise_variance: [f32; 3]) -> Self {
        Self::new(landmark, gain, FULL_SEARCH_GAIN, noise_variance)
    }

    /// For an object that was last seen under `gain`.
    pub(crate) fn followed(landmark: &Landmark, gain: f32, noise_variance: [f32; 3]) -> Self {
        Self::new(landmark, gain, FOLLOWED_GAIN, noise_variance)
    }

    fn new(landmark: &Landmark, gain: f32, factor: f32, noise_variance: [f32; 3]) -> Self {
        let cone = |shade: &ColorStats| {
            let norm2 = shade.mean.iter().map(|m| m * m).sum::<f32>().max(25.0);
            let tolerance = |c: usize| {
                let spread = 2.5 * (shade.variance[c].min(400.0) + noise_variance[c]).sqrt();
                landmark.tolerance.mean[c].max(spread).clamp(TOLERANCE.0, TOLERANCE.1)
            };
            Cone {
                shade: shade.mean,
                tolerance: std::array::from_fn(tolerance),
                onto_shade: shade.mean.map(|m| m / norm2),
                gain: (gain / factor, gain * factor),
            }
        };
        let far = face::far_view(landmark);
        let plain =
            landmark.shades.iter().enumerate().filter(|(at, _)| Some(*at) != far).map(|(_, shade)| shade);
        Self { cones: plain.map(cone).collect(), face: far.and_then(|at| Face::of(landmark, at, gain)) }
    }

    /// The same, but tints paler than `palest` (a part of the pure shade's distance from grey) are not the landmark's.
    pub(crate) fn with_palest(&self, palest: f32) -> Self {
        let face = self.face.map(|face| face.with_palest(palest));
        Self { face, ..self.clone() }
    }

    /// The widest channel's tolerance over the descriptor's.
    pub(crate) fn tolerance_scale(&self, landmark: &Landmark) -> f32 {
        let given = landmark.tolerance.mean;
        let scale = |cone: &Cone| (0..3).map(|c| cone.tolerance[c] / given[c].max(1.0)).fold(0.0, f32::max);
        self.cones.iter().map(scale).fold(0.0, f32::max)
    }

    /// Whether a pixel may be the landmark's.
    pub(crate) fn matches(&self, pixel: [u8; 3]) -> bool {
        let color = pixel.map(f32::from);
        self.face.is_some_and(|face| face.has_tint(color)) || self.matches_shade(color)
    }

    fn matches_shade(&self, color: [f32; 3]) -> bool {
        self.cones.iter().any(|cone| {
            let gain = cone.gain_of(color);
            (0..3).all(|c| (color[c] - gain * cone.shade[c]).abs() <= cone.tolerance[c])
        })
    }

    /// The face of a lettered sign; `None` of other landmarks.
    pub(crate) fn face(&self) -> Option<&Face> {
        self.face.as_ref()
    }

    /// The comparison with the nearest shade.
    pub(crate) fn nearest(&self, color: [f32; 3]) -> Match {
        let nothing = Match { gain: 1.0, excess: f32::MAX };
        self.cones
            .iter()
            .map(|cone| cone.compare(color))
            .min_by(|a, b| a.excess.total_cmp(&b.excess))
            .unwrap_or(nothing)
    }
}

impl Cone {
    fn compare(&self, color: [f32; 3]) -> Match {
        let gain = self.gain_of(color);
        let off = |c: usize| (color[c] - gain * self.shade[c]).abs() / self.tolerance[c];
        Match { gain, excess: off(0).max(off(1)).max(off(2)) }
    }

    fn gain_of(&self, color: [f32; 3]) -> f32 {
        let gain = (0..3).map(|c| color[c] * self.onto_shade[c]).sum::<f32>();
        gain.clamp(self.gain.0, self.gain.1)
    }
}
