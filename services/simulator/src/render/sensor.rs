//! What camera and exposure do to the light: shake, gain and noise.

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::canvas::Canvas;

/// Standard deviation of the table's entries; nearly four of them fit into an i8.
const TABLE_SIGMA: f32 = 32.0;
const TABLE_LENGTH: usize = 1 << 16;

/// Noise without light, levels.
const READ_SIGMA: f32 = 1.8;
/// Growth of the noise with the level.
const SHOT_SIGMA_PER_LEVEL: f32 = 0.008;
/// Noise as stated, in quarters.
pub(crate) const FINE_GRAIN_Q2: i16 = 4;
/// The greatest gain that the 16-bit arithmetic carries.
const MOST_GAIN: f64 = 4.0;

/// A table of Gaussian noise, read from a random place for every row.
#[derive(Debug)]
pub(crate) struct Sensor {
    noise: Vec<i8>,
    seed: u64,
}

impl Sensor {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Pcg32::seed_from_u64(seed);
        Self { noise: (0..TABLE_LENGTH).map(|_| gaussian(&mut random)).collect(), seed }
    }

    /// Multiplies each channel by its gain and adds the noise of frame `index`, `grain_q2` quarters of the usual, at most
    /// 12.
    pub(crate) fn expose(&self, gain: [f64; 3], grain_q2: i16, index: u64, canvas: &mut Canvas) {
        let mut random = Pcg32::seed_from_u64(self.seed ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let samples = 3 * canvas.size().width as usize;
        let gain_q10 = gain.map(|factor| (factor.clamp(0.0, MOST_GAIN) * 1_024.0).round() as u16);
        let gain_q10: Vec<u16> = gain_q10.into_iter().cycle().take(samples).collect();
        for row in canvas.rows_mut() {
            let start = random.random_range(0..TABLE_LENGTH - samples);
            expose_row(row, &gain_q10, grain_q2, &self.noise[start..start + samples]);
        }
    }
}

/// In 16 bits throughout, which lets the compiler take eight samples at a time on any x86-64.
fn expose_row(row: &mut [u8], gain_q10: &[u16], grain_q2: i16, noise: &[i8]) {
    const READ_Q4: i16 = (READ_SIGMA * 16.0) as i16;
    const SHOT_Q12: i16 = (SHOT_SIGMA_PER_LEVEL * 4_096.0) as i16;
    for ((sample, &gain), &noise) in row.iter_mut().zip(gain_q10).zip(noise) {
        let level_q2 = ((u32::from(u16::from(*sample) << 8) * u32::from(gain)) >> 16) as i16;
        let sigma_q4 = ((READ_Q4 + (((level_q2 >> 2).min(255) * SHOT_Q12) >> 8)) * grain_q2) >> 2;
        let noise_q2 = (i16::from(noise) * sigma_q4) >> 7;
        *sample = ((level_q2 + noise_q2 + 2) >> 2).clamp(0, 255) as u8;
    }
}

/// One entry of the table: a normal deviate (Box and Muller) times [`TABLE_SIGMA`].
fn gaussian(random: &mut impl Rng) -> i8 {
    let radius = (-2.0 * random.random_range(f32::EPSILON..1.0).ln()).sqrt();
    let deviate = radius * random.random_range(0.0..std::f32::consts::TAU).cos();
    (deviate * TABLE_SIGMA).round().clamp(-127.0, 127.0) as i8
}

/// Blurs by a motion of (x, y) pixels during the exposure, with three weights in each direction that have the
/// motion's variance, length² / 12.
pub(crate) fn shake(motion_px: [f64; 2], canvas: &mut Canvas) {
    let side_q8 = motion_px.map(|length| (256.0 * (length * length / 24.0).min(1.0 / 3.0)).round() as u16);
    if side_q8[0] > 0 {
        let mut before = Vec::new();
        for row in canvas.rows_mut() {
            before.clear();
            before.extend_from_slice(row);
            let middle = &mut row[3..before.len() - 3];
            weigh(middle, &before[..before.len() - 6], &before[6..], side_q8[0]);
        }
    }
    if side_q8[1] > 0 {
        shake_vertically(side_q8[1], canvas);
    }
}

fn shake_vertically(side_q8: u16, canvas: &mut Canvas) {
    let stride = 3 * canvas.size().width as usize;
    let mut above = canvas.rgb()[..stride].to_vec();
    let mut here = Vec::with_capacity(stride);
    let mut rest = canvas.rgb_mut();
    while rest.len() > stride {
        let (row, below) = rest.split_at_mut(stride);
        here.clear();
        here.extend_from_slice(row);
        weigh(row, &above, &below[..stride], side_q8);
        std::mem::swap(&mut above, &mut here);
        rest = below;
    }
}

/// Each sample becomes the mean of itself and its neighbours `a` and `b`, which weigh `side_q8` / 256 each.
fn weigh(samples: &mut [u8], a: &[u8], b: &[u8], side_q8: u16) {
    let middle_q8 = 256 - 2 * side_q8;
    for ((sample, a), b) in samples.iter_mut().zip(a).zip(b) {
        *sample =
            ((u16::from(*sample) * middle_q8 + (u16::from(*a) + u16::from(*b)) * side_q8 + 128) >> 8) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vision::SizePx;

    #[test]
    fn noise_has_the_stated_strength_and_no_bias() {
        let sensor = Sensor::new(3);
        for level in [0_u8, 60, 200] {
            let mut canvas = Canvas::new(SizePx { width: 320, height: 200 });
            canvas.rgb_mut().fill(level);
            sensor.expose([1.0; 3], FINE_GRAIN_Q2, 5, &mut canvas);
            let count = canvas.rgb().len() as f64;
            let mean = canvas.rgb().iter().map(|&v| f64::from(v)).sum::<f64>() / count;
            let variance = canvas.rgb().iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / count;
            if level > 0 {
                assert!((mean - f64::from(level)).abs() < 0.15, "{mean}");
                let sigma = f64::from(READ_SIGMA + SHOT_SIGMA_PER_LEVEL * f32::from(level));
                assert!((variance.sqrt() - sigma).abs() < 0.35, "{} {sigma}", variance.sqrt());
            }
        }
    }

    #[test]
    fn shaking_keeps_the_light_and_spreads_an_edge_evenly() {
        let mut canvas = Canvas::new(SizePx { width: 9, height: 7 });
        let middle = 3 * (3 * 9 + 4);
        canvas.rgb_mut()[middle..middle + 3].fill(240);
        shake([2.0, 1.0], &mut canvas);
        let sum: u32 = canvas.rgb().iter().map(|&v| u32::from(v)).sum();
        assert!(sum.abs_diff(720) < 12, "{sum}");
        let at = |x: usize, y: usize| canvas.rgb()[3 * (9 * y + x)];
        assert_eq!((at(3, 3), at(4, 2)), (at(5, 3), at(4, 4)));
        assert!(at(3, 3) > at(4, 2) && at(4, 3) > at(3, 3));
    }
}
