//! Noise on computed pictures, the same each time.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use vision::methods::Plane;

const SEED: u64 = 21;

/// A kind of noise.
#[derive(Clone, Copy, Debug)]
pub(super) enum Noise {
    /// Of this standard deviation, in levels.
    Gaussian(f32),
    /// This part of the pixels is black or white.
    Impulses(f64),
}

/// The picture with noise, within 0 and 255.
pub(super) fn noisy(plane: &Plane, noise: Noise) -> Plane {
    let mut random = Pcg32::seed_from_u64(SEED);
    Plane::from_fn(plane.size(), |x, y| {
        let level = plane.get(x, y);
        match noise {
            Noise::Gaussian(sigma) => (level + sigma * normal(&mut random)).clamp(0.0, 255.0),
            Noise::Impulses(part) if random.random::<f64>() < part => {
                if random.random::<f64>() < 0.5 {
                    0.0
                } else {
                    255.0
                }
            }
            Noise::Impulses(_) => level,
        }
    })
}

/// A normal variable of variance 1 (Box and Muller 1958).
fn normal(random: &mut Pcg32) -> f32 {
    let (radius, turn) = (random.random::<f64>().max(f64::MIN_POSITIVE), random.random::<f64>());
    ((-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use vision::SizePx;

    #[test]
    fn gaussian_noise_has_the_variance_that_was_asked_for() {
        let grey = Plane::from_fn(SizePx { width: 200, height: 200 }, |_, _| 128.0);
        let noisy = noisy(&grey, Noise::Gaussian(10.0));
        let squares: f32 = noisy.values().iter().map(|value| (value - 128.0).powi(2)).sum();
        assert!((squares / 40_000.0 - 100.0).abs() < 5.0);
    }
}
