//! Phase correlation (thesis 2.7.3, frequency domain): the shift between two pictures from the phases of their spectra.
//!
//! The cross-power spectrum, each bin divided by its magnitude, belongs to a picture with one peak at the shift. The peak
//! gives whole pixels. The fraction is the shift whose phases fit those of the cross-power spectrum best over the lower
//! frequencies: Σ w cos(residual phase) is maximised by Newton steps, w being the root of the bin's magnitude. High
//! frequencies are left out because that is where a camera's pixels alias and where noise is.

use std::f64::consts::TAU;

use realfft::num_complex::Complex32;

use super::fourier::{Fourier, NoPixels, Spectrum};
use super::plane::{Plane, SizesDiffer};
use crate::geometry::SizePx;

/// Frequencies up to this part of the sampling frequency tell the fraction of a pixel.
const HIGHEST_FREQUENCY: f64 = 0.25;
/// A bin whose magnitude is a smaller part of the largest one's is nothing but rounding, and has no phase.
const LEAST_SHARE: f32 = 1e-9;
const NEWTON_STEPS: usize = 8;

/// By how much the second picture's content lies further right and down than the first's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// Columns to the right, within ± half the width.
    pub dx_px: f32,
    /// Rows down, within ± half the height.
    pub dy_px: f32,
    /// Height of the peak: 1 for a mere shift, near 0 for pictures that have nothing in common.
    pub peak: f32,
}

/// What is done about the picture's edges, which the transform takes to touch each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Taper {
    /// Nothing: for pictures that do continue at the other side.
    None,
    /// The picture fades towards its edges (Hann window).
    #[default]
    Hann,
}

/// Phase correlation of pictures of one size, with its tables and memory.
#[derive(Clone, Debug)]
pub struct PhaseCorrelator {
    fourier: Fourier,
    fade: Fade,
    /// The spectra of the first picture and the second, which becomes the cross-power spectrum.
    first: Spectrum,
    cross: Spectrum,
    weights: Vec<f32>,
    surface: Plane,
}

/// The taper's factors along x and along y.
#[derive(Clone, Debug)]
struct Fade {
    along_x: Vec<f32>,
    along_y: Vec<f32>,
}

impl PhaseCorrelator {
    /// Plans for pictures of that size.
    ///
    /// # Errors
    /// When they have no pixel.
    pub fn new(size: SizePx, taper: Taper) -> Result<Self, NoPixels> {
        Ok(Self {
            fourier: Fourier::new(size)?,
            fade: Fade { along_x: taper.factors(size.width), along_y: taper.factors(size.height) },
            first: Spectrum::default(),
            cross: Spectrum::default(),
            weights: Vec::new(),
            surface: Plane::default(),
        })
    }

    /// The shift from `first` to `second`.
    ///
    /// # Errors
    /// When one of them has another size than was planned for.
    pub fn shift(&mut self, first: &Plane, second: &Plane) -> Result<Shift, SizesDiffer> {
        let planned = self.fourier.size();
        for size in [first.size(), second.size()] {
            if size != planned {
                return Err(SizesDiffer { left: planned, right: size });
            }
        }
        self.fade.transform(&mut self.fourier, first, &mut self.first);
        self.fade.transform(&mut self.fourier, second, &mut self.cross);
        self.make_cross_power();
        let mut used_up = self.cross.clone();
        self.fourier.inverse(&mut used_up, &mut self.surface);
        let (x, y, peak) = self.surface.maximum().unwrap_or_default();
        let whole = (signed(x, planned.width), signed(y, planned.height));
        let (dx, dy) = self.refined(whole);
        Ok(Shift { dx_px: dx as f32, dy_px: dy as f32, peak })
    }

    /// The picture with the peak, of the last shift: the value at (x, y) speaks for a shift of that many pixels, counted
    /// around the size.
    #[must_use]
    pub fn surface(&self) -> &Plane {
        &self.surface
    }

    /// conj(F₁) F₂, divided by its magnitude, whose root is kept as the bin's weight.
    fn make_cross_power(&mut self) {
        let bins = self.cross.bins_mut();
        for (cross, first) in bins.iter_mut().zip(self.first.bins()) {
            *cross *= first.conj();
        }
        let largest = bins.iter().map(|bin| bin.norm()).fold(0.0, f32::max);
        self.weights.clear();
        self.weights.extend(bins.iter_mut().map(|bin| {
            let magnitude = bin.norm();
            if magnitude <= LEAST_SHARE * largest {
                *bin = Complex32::default();
                return 0.0;
            }
            *bin /= magnitude;
            magnitude.sqrt()
        }));
    }

    /// The shift near `whole` with the best phases, or `whole` where the phases leave it open.
    fn refined(&self, whole: (f64, f64)) -> (f64, f64) {
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
        let SizePx { width, height } = self.fourier.size();
        let highest = |side: u32| (HIGHEST_FREQUENCY * f64::from(side)) as i64;
        let (mut slope, mut bend) = ([0.0; 2], [0.0; 3]);
        for u in 0..=highest(width) {
            for v in -highest(height)..=highest(height) {
                let at = u as usize * height as usize + v.rem_euclid(height.into()) as usize;
                let bin = self.cross.bins()[at];
                let (x, y) = (TAU * u as f64 / f64::from(width), TAU * v as f64 / f64::from(height));
                // Columns other than the first stand for their conjugates too.
                let weight = f64::from(self.weights[at]) * if u == 0 { 1.0 } else { 2.0 };
                let (sin, cos) = (x * dx + y * dy).sin_cos();
                let (re, im) = (f64::from(bin.re), f64::from(bin.im));
                let (along, across) = (weight * (re * cos - im * sin), weight * (re * sin + im * cos));
                slope = [slope[0] - x * across, slope[1] - y * across];
                bend = [bend[0] + x * x * along, bend[1] + x * y * along, bend[2] + y * y * along];
            }
        }
        solve(bend, slope)
    }
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

impl Taper {
    fn factors(self, length: u32) -> Vec<f32> {
        let hann = |at: u32| {
            let turn = TAU * (f64::from(at) + 0.5) / f64::from(length);
            (0.5 - 0.5 * turn.cos()) as f32
        };
        (0..length).map(|at| if self == Self::None { 1.0 } else { hann(at) }).collect()
    }
}

impl Fade {
    /// The spectrum of a faded picture. Its mean is taken away first, or the fading itself would be seen.
    fn transform(&self, fourier: &mut Fourier, plane: &Plane, spectrum: &mut Spectrum) {
        let total: f64 = plane.values().iter().map(|&value| f64::from(value)).sum();
        let mean = (total / plane.values().len().max(1) as f64) as f32;
        let fill = |y: usize, row: &mut [f32]| {
            let values = plane.row(y as u32).iter().zip(&self.along_x);
            for (faded, (value, factor)) in row.iter_mut().zip(values) {
                *faded = (value - mean) * factor * self.along_y[y];
            }
        };
        fourier.forward_rows(plane.height() as usize, plane.width() as usize, fill, spectrum);
    }
}

/// A place of the surface as a shift: beyond the half it is one to the left or up.
fn signed(at: u32, length: u32) -> f64 {
    f64::from(at) - if at > length / 2 { f64::from(length) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::reference::any_plane;
    use proptest::prelude::*;

    fn moved_around(plane: &Plane, dx: u32, dy: u32) -> Plane {
        let SizePx { width, height } = plane.size();
        Plane::from_fn(plane.size(), |x, y| plane.get((x + width - dx) % width, (y + height - dy) % height))
    }

    #[test]
    fn pictures_of_another_size_are_refused() {
        let mut correlator = PhaseCorrelator::new(SizePx { width: 4, height: 4 }, Taper::Hann).unwrap();
        assert!(correlator.shift(&Plane::default(), &Plane::default()).is_err());
        assert!(PhaseCorrelator::new(SizePx { width: 4, height: 0 }, Taper::Hann).is_err());
    }

    #[test]
    fn pictures_without_content_have_no_shift() {
        for (width, height) in [(1, 1), (5, 4), (8, 1)] {
            let flat = Plane::from_fn(SizePx { width, height }, |_, _| 9.0);
            let mut correlator = PhaseCorrelator::new(flat.size(), Taper::None).unwrap();
            assert_eq!(correlator.shift(&flat, &flat).unwrap(), Shift::default());
        }
    }

    proptest! {
        #[test]
        fn whole_shifts_are_exact(seed in any::<u64>(), width in 8u32..40, height in 8u32..40, dx in 0u32..40, dy in 0u32..40) {
            let mut state = seed | 1;
            let noise = Plane::from_fn(SizePx { width, height }, |_, _| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 56) as f32
            });
            let (dx, dy) = (dx % width, dy % height);
            let mut correlator = PhaseCorrelator::new(noise.size(), Taper::None).unwrap();
            let shift = correlator.shift(&noise, &moved_around(&noise, dx, dy)).unwrap();
            prop_assert!((f64::from(shift.dx_px) - signed(dx, width)).abs() < 1e-3, "{shift:?}");
            prop_assert!((f64::from(shift.dy_px) - signed(dy, height)).abs() < 1e-3, "{shift:?}");
            prop_assert!(shift.peak > 0.98, "{shift:?}");
        }

        #[test]
        fn whatever_the_pictures_the_shift_is_a_number(first in any_plane(12), seed in any::<u64>()) {
            prop_assume!(!first.is_empty());
            let second = Plane::from_fn(first.size(), |x, y| ((seed >> ((x + 5 * y) % 60)) & 255) as f32);
            for taper in [Taper::None, Taper::Hann] {
                let shift = PhaseCorrelator::new(first.size(), taper).unwrap().shift(&first, &second).unwrap();
                prop_assert!(shift.dx_px.is_finite() && shift.dy_px.is_finite() && shift.peak.is_finite());
            }
        }
    }
}
