//! Phase correlation (thesis 2.7.3, frequency domain): the shift between two pictures from the phases of their spectra.
//!
//! The cross-power spectrum, each bin divided by its magnitude, belongs to a picture with one peak at the shift. The peak
//! gives whole pixels. The fraction is the shift whose phases fit those of the cross-power spectrum best over the lower
//! frequencies: Σ w cos(residual phase) is maximised by Newton steps, w being the root of the bin's magnitude. High
//! frequencies are left out because that is where a camera's pixels alias and where noise is.
//!
//! Fading the edges hides that pictures do not continue at the other side, but what moves under a fade that does not
//! changes. So once whole pixels are known, both pictures are faded again around what both show.

mod fraction;
mod taper;

use realfft::num_complex::Complex32;

use super::fourier::{Fourier, NoPixels, Spectrum};
use super::plane::{Plane, SizesDiffer};
use crate::geometry::SizePx;

use fraction::Phases;
use taper::{Fade, overlap};

pub use taper::Taper;

/// A bin whose magnitude is a smaller part of the largest one's is nothing but rounding, and has no phase.
const LEAST_SHARE: f32 = 1e-9;

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

/// Phase correlation of pictures of one size, with its tables and memory.
#[derive(Clone, Debug)]
pub struct PhaseCorrelator {
    fourier: Fourier,
    taper: Taper,
    fade: Fade,
    /// The spectra of the first picture and the second, which becomes the cross-power spectrum.
    first: Spectrum,
    cross: Spectrum,
    weights: Vec<f32>,
    used_up: Spectrum,
    surface: Plane,
}

impl PhaseCorrelator {
    /// Plans for pictures of that size.
    ///
    /// # Errors
    /// When they have no pixel.
    pub fn new(size: SizePx, taper: Taper) -> Result<Self, NoPixels> {
        Ok(Self {
            fourier: Fourier::new(size)?,
            taper,
            fade: Fade::new(size, taper),
            first: Spectrum::default(),
            cross: Spectrum::default(),
            weights: Vec::new(),
            used_up: Spectrum::default(),
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
        self.used_up.clone_from(&self.cross);
        self.fourier.inverse(&mut self.used_up, &mut self.surface);
        let (x, y, peak) = self.surface.maximum().unwrap_or_default();
        let whole = (signed(x, planned.width), signed(y, planned.height));
        if self.taper == Taper::Hann && whole != (0, 0) {
            let [fade, fade_of_second] = overlap(planned, whole);
            fade.transform(&mut self.fourier, first, &mut self.first);
            fade_of_second.transform(&mut self.fourier, second, &mut self.cross);
            self.make_cross_power();
        }
        let phases = Phases { size: planned, bins: self.cross.bins(), weights: &self.weights };
        let (dx, dy) = phases.best_shift((whole.0 as f64, whole.1 as f64));
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
        let largest = bins.iter().map(|bin| bin.norm_sqr()).fold(0.0, f32::max).sqrt();
        self.weights.clear();
        self.weights.extend(bins.iter_mut().map(|bin| {
            let magnitude = bin.norm_sqr().sqrt();
            if magnitude <= LEAST_SHARE * largest {
                *bin = Complex32::default();
                return 0.0;
            }
            *bin /= magnitude;
            magnitude.sqrt()
        }));
    }
}

/// A place of the surface as a shift: beyond the half it is one to the left or up.
fn signed(at: u32, length: u32) -> i64 {
    i64::from(at) - if at > length / 2 { i64::from(length) } else { 0 }
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
            prop_assert!((shift.dx_px - signed(dx, width) as f32).abs() < 1e-3, "{shift:?}");
            prop_assert!((shift.dy_px - signed(dy, height) as f32).abs() < 1e-3, "{shift:?}");
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
