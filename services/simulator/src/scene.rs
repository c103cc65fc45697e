//! The scenes: each builds a [`World`] from its seed.

mod film;
mod green_signs;
mod lettering;
mod rink;
mod roadside;
mod stop_sign;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::drive::Wave;
use crate::options::{Look, SceneKind, SceneOptions};
use crate::simulator::Optics;
use crate::vector::Vec3;
use crate::world::{Colour, Light, World};

/// Part of the time between two frames during which the shutter is open.
const SHUTTER: f64 = 0.3;

/// The world of a scene, the same for all vehicles but for their way, and the light as this vehicle's camera sees it.
pub(crate) fn build(options: &SceneOptions) -> (World, Optics) {
    let mut dice = Dice::new(options.seed, options.kind as u64);
    let mut vehicle_dice = Dice::new(options.seed, 1_000 + u64::from(options.vehicle));
    let world = match options.kind {
        SceneKind::Rink => rink::world(options, &mut dice, &mut vehicle_dice),
        SceneKind::StopSign => stop_sign::world(options, &mut dice, &mut vehicle_dice),
        SceneKind::GreenSigns => green_signs::world(options, &mut dice, &mut vehicle_dice),
    };
    let optics = optics(&mut vehicle_dice);
    match options.look {
        Look::Clean => (world, optics),
        Look::Film => film::shot(options, world, optics),
    }
}

/// A white balance within 4 %, and an exposure that swings by up to 10 % with a flicker of 1 %.
fn optics(dice: &mut Dice) -> Optics {
    let brightness = dice.within(0.95, 1.05);
    Optics {
        shutter: SHUTTER,
        balance: std::array::from_fn(|_| brightness * dice.within(0.97, 1.03)),
        swing: vec![dice.wave(0.05..0.09, 0.15..0.4), dice.wave(0.005..0.01, 3.0..7.0)],
        film: None,
    }
}

/// Random choices of a scene.
pub(crate) struct Dice {
    random: Pcg32,
}

impl Dice {
    fn new(seed: u64, stream: u64) -> Self {
        Self { random: Pcg32::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(stream)) }
    }

    /// Evenly between two numbers.
    fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.random.random::<f64>()
    }

    /// Around 0, at most `most` away.
    fn around_zero(&mut self, most: f64) -> f64 {
        self.within(-most, most)
    }

    /// True with that probability.
    fn chance(&mut self, probability: f64) -> bool {
        self.random.random::<f64>() < probability
    }

    fn seed(&mut self) -> u64 {
        self.random.random()
    }

    fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.random.random_range(0..values.len())]
    }

    /// `colour` with each channel up to `most` levels off.
    fn tinted(&mut self, colour: Colour, most: f64) -> Colour {
        colour.map(|channel| (channel + self.around_zero(most)).clamp(0.0, 255.0))
    }

    fn wave(&mut self, amplitude: std::ops::Range<f64>, rate: std::ops::Range<f64>) -> Wave {
        Wave {
            amplitude: self.within(amplitude.start, amplitude.end),
            rate: self.within(rate.start, rate.end),
            phase_rad: self.within(0.0, std::f64::consts::TAU),
        }
    }

    /// Two waves: a slower one, and a faster one of about half its size.
    fn vibration(&mut self, amplitude: f64, slow_hz: std::ops::Range<f64>) -> Vec<Wave> {
        let fast_hz = slow_hz.end..3.0 * slow_hz.end;
        vec![
            self.wave(0.6 * amplitude..amplitude, slow_hz),
            self.wave(0.3 * amplitude..0.6 * amplitude, fast_hz),
        ]
    }

    /// Swaps the values into a random order.
    fn shuffle<T>(&mut self, values: &mut [T]) {
        for last in (1..values.len()).rev() {
            values.swap(last, self.random.random_range(0..=last));
        }
    }

    /// A light from behind the camera's left or right; in one of five worlds it casts no shadows.
    fn light(&mut self, ambient: f64) -> Light {
        let side = if self.chance(0.5) { 1.0 } else { -1.0 };
        let towards = Vec3::new(self.within(-0.8, 0.1), side * self.within(0.3, 1.0), self.within(0.9, 1.6));
        let shadow_darkness = if self.chance(0.2) { 0.0 } else { self.within(0.35, 0.6) };
        Light { towards: towards.normalised(), ambient, shadow_darkness }
    }
}
