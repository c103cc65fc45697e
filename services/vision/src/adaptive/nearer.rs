//! Which pixels are nearer to an object's colours than to those around it.

use super::palette::Cluster;
use super::patch::Judge;
use super::shadow::Cast;
use super::word::{WORD_PX, packed, split};

/// How much darker or lighter than its palette the object's pixels may be, and how much lighter at no cost: a face turned
/// to the light is much lighter than the others.
const SHADING: (f32, f32) = (0.82, 1.7);
const FREE_LIGHT: f32 = 1.18;
/// What a level beyond the free shading costs, levels.
const SHADING_COST: f32 = 0.4;

/// Tells the pixels that are nearer to one of the object's own colours, each with the light that suits it best, than to any
/// of the others and to the shadow that it casts.
pub(super) struct Nearer<'a> {
    pub(super) own: &'a [Cluster],
    pub(super) others: &'a [Cluster],
    pub(super) cast: Option<&'a Cast<'a>>,
}

impl Judge for Nearer<'_> {
    #[inline(always)]
    fn wanted(&self, rgb: &[u8]) -> u64 {
        let levels = split(rgb);
        let (mut own, mut others) = ([f32::MAX; WORD_PX], [f32::MAX; WORD_PX]);
        for cluster in self.own {
            let shaded = Shaded::new(cluster);
            for at in 0..WORD_PX {
                let distance2 = shaded.distance2([levels[0][at], levels[1][at], levels[2][at]]);
                own[at] = lesser(own[at], distance2);
            }
        }
        for cluster in self.others {
            for at in 0..WORD_PX {
                let off = [
                    cluster.mean[0] - levels[0][at],
                    cluster.mean[1] - levels[1][at],
                    cluster.mean[2] - levels[2][at],
                ];
                others[at] = lesser(others[at], off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
            }
        }
        if let Some(cast) = self.cast {
            for at in 0..WORD_PX {
                let distance2 = cast.distance2([levels[0][at], levels[1][at], levels[2][at]]);
                others[at] = lesser(others[at], distance2);
            }
        }
        let mut nearer = [0; WORD_PX];
        for at in 0..WORD_PX {
            nearer[at] = (own[at] < others[at]) as u8;
        }
        packed(&nearer)
    }
}

/// A colour with more or less light on it.
struct Shaded {
    mean: [f32; 3],
    /// Squared length of the mean, and one over it.
    length2: f32,
    inverse: f32,
}

impl Shaded {
    #[inline(always)]
    fn new(&Cluster { mean, .. }: &Cluster) -> Self {
        let length2 = mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2];
        let length2 = if length2 > 1.0 { length2 } else { 1.0 };
        Self { mean, length2, inverse: 1.0 / length2 }
    }

    /// Squared distance of a colour from this one with the light that suits it best, levels².
    #[inline(always)]
    fn distance2(&self, color: [f32; 3]) -> f32 {
        let [r, g, b] = self.mean;
        let gain = (r * color[0] + g * color[1] + b * color[2]) * self.inverse;
        let gain = if gain > SHADING.0 { gain } else { SHADING.0 };
        let gain = if gain < SHADING.1 { gain } else { SHADING.1 };
        let (dr, dg, db) = (gain * r - color[0], gain * g - color[1], gain * b - color[2]);
        let beyond = if gain > FREE_LIGHT { SHADING_COST * (gain - FREE_LIGHT) } else { 0.0 };
        dr * dr + dg * dg + db * db + beyond * beyond * self.length2
    }
}

/// Plainer than `f32::min`, which has to think of what is no number.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn clusters(most: usize) -> impl Strategy<Value = Vec<Cluster>> {
        let cluster = prop::array::uniform3(0.0f32..255.0).prop_map(|mean| Cluster { mean, pixels: 1 });
        prop::collection::vec(cluster, 1..=most)
    }

    /// Squared distance of a colour from another with light that is searched for step by step.
    fn slowly(mean: [f32; 3], color: [f32; 3]) -> f32 {
        let steps = (0..=8800).map(|step| SHADING.0 + 1e-4 * step as f32);
        let off2 = |gain: f32| (0..3).map(|c| (gain * mean[c] - color[c]).powi(2)).sum::<f32>();
        let best = steps.min_by(|a, b| off2(*a).total_cmp(&off2(*b))).unwrap();
        let length2 = mean.iter().map(|m| m * m).sum::<f32>().max(1.0);
        off2(best) + (SHADING_COST * (best - FREE_LIGHT).max(0.0)).powi(2) * length2
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn pixels_are_nearer_that_are_nearer(
            own in clusters(3), others in clusters(4), rgb in prop::collection::vec(any::<u8>(), 3 * 20),
        ) {
            let wanted = Nearer { own: &own, others: &others, cast: None }.wanted(&rgb);
            for (at, pixel) in rgb.as_chunks::<3>().0.iter().enumerate() {
                let color = pixel.map(f32::from);
                let near = own.iter().map(|own| slowly(own.mean, color)).fold(f32::MAX, f32::min);
                let off2 = |mean: [f32; 3]| (0..3).map(|c| (mean[c] - color[c]).powi(2)).sum::<f32>();
                let far = others.iter().map(|other| off2(other.mean)).fold(f32::MAX, f32::min);
                // The light is told in steps: where both are nearly as near, either is right.
                if (near - far).abs() > 10.0 {
                    prop_assert_eq!(wanted >> at & 1 == 1, near < far, "{} {}", near, far);
                }
            }
        }
    }
}
