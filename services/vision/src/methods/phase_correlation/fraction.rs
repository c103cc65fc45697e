//! The fraction of a pixel in a shift, from the phases of the lower frequencies.

use std::f64::consts::TAU;

use realfft::num_complex::Complex32;

use crate::geometry::SizePx;

/// Frequencies up to this part of the sampling frequency tell the fraction of a pixel.
const HIGHEST_FREQUENCY: f64 = 0.25;
const NEWTON_STEPS: usize = 8;

/// The cross-power spectrum of two pictures of that size, each bin of magnitude 1 or 0, and what weight it has.
pub(super) struct Phases<'a> {
    pub(super) size: SizePx,
    pub(super) bins: &'a [Complex32],
    pub(super) weights: &'a [f32],
}

impl Phases<'_> {
    /// The shift near `whole` with the best phases, or `whole` where the phases leave it open.
    pub(super) fn best_shift(&self, whole: (f64, f64)) -> (f64, f64) {
        let mut shift = whole;
        for _ in 0..NEWTON_STEPS {
            let Some((x, y)) = self.newton_step(shift) else { return whole };
            shift = (shift.0 + x, shift.1 + y);
            if (shift.0 - whole.0).abs() > 1.0 || (shift.1 - whole.1).abs() > 1.0 {
                return whole;
            }
            if x.abs().max(y.abs()) < 1e-6 {
                break;
            }
        }
        shift
    }

    /// One step towards the top of Σ w cos(phase + ω · shift); `None` where that has no top.
    fn newton_step(&self, (dx, dy): (f64, f64)) -> Option<(f64, f64)> {
        let SizePx { width, height } = self.size;
        let rows = turns(height, dy);
        let (mut slope, mut bend) = ([0.0; 2], [0.0; 3]);
        for turned in turns(width, dx).iter().filter(|turned| turned.bin >= 0) {
            let first = turned.bin as usize * height as usize;
            // Columns other than the first stand for their conjugates too.
            let count = if turned.bin == 0 { 1.0 } else { 2.0 };
            for row in &rows {
                let at = first + row.bin.rem_euclid(height.into()) as usize;
                let bin = self.bins[at];
                let weight = count * f64::from(self.weights[at]);
                let (x, y, (re, im)) = (turned.omega, row.omega, times(turned.by, row.by));
                let (along, across) = times((f64::from(bin.re), f64::from(bin.im)), (re, im));
                let (along, across) = (weight * along, weight * across);
                slope = [slope[0] - x * across, slope[1] - y * across];
                bend = [bend[0] + x * x * along, bend[1] + x * y * along, bend[2] + y * y * along];
            }
        }
        solve(bend, slope)
    }
}

/// One of the lower frequencies along a side.
struct Turn {
    bin: i64,
    /// In radians a pixel.
    omega: f64,
    /// e^(iω · shift).
    by: (f64, f64),
}

/// The lower frequencies of a side of that length, with what turns a shift back.
fn turns(length: u32, shift: f64) -> Vec<Turn> {
    let highest = (HIGHEST_FREQUENCY * f64::from(length)) as i64;
    let turn = |bin: i64| {
        let omega = TAU * bin as f64 / f64::from(length);
        let (sin, cos) = (omega * shift).sin_cos();
        Turn { bin, omega, by: (cos, sin) }
    };
    (-highest..=highest).map(turn).collect()
}

/// The product of two complex numbers.
fn times((a, b): (f64, f64), (c, d): (f64, f64)) -> (f64, f64) {
    (a * c - b * d, a * d + b * c)
}

/// The step s with B s = `slope`, B being symmetric: xx, xy, yy. A direction without any frequency is left alone.
fn solve([xx, xy, yy]: [f64; 3], slope: [f64; 2]) -> Option<(f64, f64)> {
    let determinant = xx * yy - xy * xy;
    if determinant > 1e-9 * xx * yy && xx > 0.0 && yy > 0.0 {
        return Some((
            (slope[0] * yy - slope[1] * xy) / determinant,
            (slope[1] * xx - slope[0] * xy) / determinant,
        ));
    }
    if xx > 0.0 && yy == 0.0 {
        return Some((slope[0] / xx, 0.0));
    }
    (yy > 0.0 && xx == 0.0).then(|| (0.0, slope[1] / yy))
}
