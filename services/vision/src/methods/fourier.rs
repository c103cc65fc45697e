//! The two-dimensional Fourier transform of a real picture and back (thesis eqs. 2.6, 2.7).
//!
//! Forward without a factor, back with 1/MN. (Printed, both have it; then going there and back would divide by MN.)
//! The spectrum of a real picture repeats itself, conjugated, so only the columns 0..=width/2 are kept; they lie one after
//! the other, because that is how the second half of the work wants them.

use std::fmt;
use std::sync::Arc;

use realfft::num_complex::Complex32;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

use super::plane::Plane;
use crate::geometry::SizePx;

/// Rows that are turned into columns together: as many complex numbers as a cache line holds.
const BLOCK: usize = 8;

/// A transform of no pixels was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a Fourier transform of {}×{} pixels; both sides must be at least 1", size.width, size.height)]
pub struct NoPixels {
    /// What was asked for.
    pub size: SizePx,
}

/// The transforms of one size, with their tables and memory.
#[derive(Clone)]
pub struct Fourier {
    size: SizePx,
    along_rows: Arc<dyn RealToComplex<f32>>,
    along_rows_back: Arc<dyn ComplexToReal<f32>>,
    along_columns: Arc<dyn Fft<f32>>,
    along_columns_back: Arc<dyn Fft<f32>>,
    row: Vec<f32>,
    block: Vec<Complex32>,
    scratch: Vec<Complex32>,
}

/// The half of a spectrum that determines the rest: F(u, v) for u in 0..=width/2, column after column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    bins: Vec<Complex32>,
}

impl Spectrum {
    /// F(u, v), u-major: `bins[u * height + v]`.
    #[must_use]
    pub fn bins(&self) -> &[Complex32] {
        &self.bins
    }

    /// The same, to be changed.
    pub fn bins_mut(&mut self) -> &mut [Complex32] {
        &mut self.bins
    }

    /// Multiplies by another spectrum, which is the convolution of eq. 2.8.
    pub fn multiply(&mut self, other: &Self) {
        for (bin, other) in self.bins.iter_mut().zip(&other.bins) {
            *bin *= other;
        }
    }

    /// Makes this the product of two spectra.
    pub(super) fn set_product(&mut self, one: &Self, other: &Self) {
        self.bins.clear();
        self.bins.extend(one.bins.iter().zip(&other.bins).map(|(one, other)| one * other));
    }

    /// Adds the product of two spectra.
    pub(super) fn add_product(&mut self, one: &Self, other: &Self) {
        for (bin, (one, other)) in self.bins.iter_mut().zip(one.bins.iter().zip(&other.bins)) {
            *bin += one * other;
        }
    }
}

impl Fourier {
    /// Plans transforms of `size`; [`fast_length`] names sizes that are fast.
    ///
    /// # Errors
    /// When there is no pixel to transform.
    pub fn new(size: SizePx) -> Result<Self, NoPixels> {
        if size.width == 0 || size.height == 0 {
            return Err(NoPixels { size });
        }
        let (width, height) = (size.width as usize, size.height as usize);
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        let (along_rows, along_rows_back) = (real.plan_fft_forward(width), real.plan_fft_inverse(width));
        let along_columns = complex.plan_fft_forward(height);
        let along_columns_back = complex.plan_fft_inverse(height);
        let scratch = along_rows.get_scratch_len().max(along_rows_back.get_scratch_len());
        let scratch = scratch.max(along_columns.get_inplace_scratch_len());
        let scratch = scratch.max(along_columns_back.get_inplace_scratch_len());
        Ok(Self {
            size,
            along_rows,
            along_rows_back,
            along_columns,
            along_columns_back,
            row: vec![0.0; width],
            block: vec![Complex32::default(); BLOCK * (width / 2 + 1)],
            scratch: vec![Complex32::default(); scratch],
        })
    }

    /// What is transformed.
    #[must_use]
    pub fn size(&self) -> SizePx {
        self.size
    }

    /// The spectrum of `plane` (eq. 2.6), which is cut, or filled up with zeros at its right and bottom, to the size.
    pub fn forward(&mut self, plane: &Plane, spectrum: &mut Spectrum) {
        let width = plane.width().min(self.size.width) as usize;
        let rows = plane.height().min(self.size.height);
        self.forward_rows(
            rows as usize,
            width,
            |y, row| row.copy_from_slice(&plane.row(y as u32)[..width]),
            spectrum,
        );
    }

    /// The spectrum of a picture whose first `rows` rows have values in their first `width` columns, which `fill` writes.
    pub(super) fn forward_rows(
        &mut self,
        rows: usize,
        width: usize,
        mut fill: impl FnMut(usize, &mut [f32]),
        spectrum: &mut Spectrum,
    ) {
        let (height, columns) = (self.size.height as usize, self.columns());
        spectrum.bins.clear();
        spectrum.bins.resize(columns * height, Complex32::default());
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            for (y, line) in (first..).zip(self.block.chunks_exact_mut(columns).take(count)) {
                // The transform uses its input as memory.
                self.row[width..].fill(0.0);
                fill(y, &mut self.row[..width]);
                let done = self.along_rows.process_with_scratch(&mut self.row, line, &mut self.scratch);
                done.expect("buffers of the planned lengths");
            }
            for (u, column) in spectrum.bins.chunks_exact_mut(height).enumerate() {
                for (row, bin) in column[first..first + count].iter_mut().enumerate() {
                    *bin = self.block[row * columns + u];
                }
            }
        }
        self.along_columns.process_with_scratch(&mut spectrum.bins, &mut self.scratch);
    }

    /// The picture of a spectrum of this size (eq. 2.7); the spectrum is used up.
    ///
    /// # Panics
    /// When the spectrum is of another size.
    pub fn inverse(&mut self, spectrum: &mut Spectrum, plane: &mut Plane) {
        plane.reset(self.size);
        let width = self.size.width as usize;
        let values = plane.values_mut();
        self.inverse_rows(spectrum, self.size.height as usize, |y, row| {
            values[y * width..][..width].copy_from_slice(row);
        });
    }

    /// Gives the first `rows` rows of the picture of a spectrum to `take`.
    pub(super) fn inverse_rows(
        &mut self,
        spectrum: &mut Spectrum,
        rows: usize,
        mut take: impl FnMut(usize, &[f32]),
    ) {
        let (height, columns) = (self.size.height as usize, self.columns());
        assert_eq!(spectrum.bins.len(), columns * height, "a spectrum of another size");
        self.along_columns_back.process_with_scratch(&mut spectrum.bins, &mut self.scratch);
        let factor = 1.0 / (self.size.width as f32 * self.size.height as f32);
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            for (u, column) in spectrum.bins.chunks_exact(height).enumerate() {
                for (row, &bin) in column[first..first + count].iter().enumerate() {
                    self.block[row * columns + u] = bin * factor;
                }
            }
            for (y, line) in (first..).zip(self.block.chunks_exact_mut(columns).take(count)) {
                // These are real but for rounding.
                line[0].im = 0.0;
                if self.size.width.is_multiple_of(2) {
                    line[columns - 1].im = 0.0;
                }
                let done = self.along_rows_back.process_with_scratch(line, &mut self.row, &mut self.scratch);
                done.expect("buffers of the planned lengths and real outer bins");
                take(y, &self.row);
            }
        }
    }

    fn columns(&self) -> usize {
        self.size.width as usize / 2 + 1
    }
}

impl fmt::Debug for Fourier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Fourier({}×{})", self.size.width, self.size.height)
    }
}

/// The next length from `least` on that has no prime factors but 2, 3 and 5, and is even: these are fast.
#[must_use]
pub fn fast_length(least: u32) -> u32 {
    let smooth = |length: &u32| {
        [2, 3, 5].into_iter().fold(*length, |mut rest, prime| {
            while rest.is_multiple_of(prime) {
                rest /= prime;
            }
            rest
        }) == 1
    };
    (least.max(2)..).find(|length| length.is_multiple_of(2) && smooth(length)).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::reference::{any_plane, assert_close};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    /// Eq. 2.6 written out, without its factor.
    fn slowly(plane: &Plane, u: u32, v: u32) -> (f64, f64) {
        let (width, height) = (f64::from(plane.width()), f64::from(plane.height()));
        let places = (0..plane.height()).flat_map(|y| (0..plane.width()).map(move |x| (x, y)));
        places.fold((0.0, 0.0), |(re, im), (x, y)| {
            let turn = TAU * (f64::from(u * x) / width + f64::from(v * y) / height);
            let value = f64::from(plane.get(x, y));
            (re + value * turn.cos(), im - value * turn.sin())
        })
    }

    #[test]
    fn lengths_that_are_fast() {
        assert_eq!([0, 2, 3, 7, 11, 480, 481, 1021].map(fast_length), [2, 2, 4, 8, 12, 480, 486, 1024]);
        let refused = Fourier::new(SizePx { width: 0, height: 4 }).unwrap_err();
        assert!(refused.to_string().contains("0×4"));
    }

    proptest! {
        #[test]
        fn bins_are_sums_over_the_picture_and_lead_back(plane in any_plane(11)) {
            prop_assume!(!plane.is_empty());
            let mut fourier = Fourier::new(plane.size()).unwrap();
            let (mut spectrum, mut again) = (Spectrum::default(), Plane::default());
            fourier.forward(&plane, &mut spectrum);
            for (at, bin) in (0..).zip(spectrum.bins()) {
                let (re, im) = slowly(&plane, at / plane.height(), at % plane.height());
                prop_assert!((re - f64::from(bin.re)).abs() + (im - f64::from(bin.im)).abs() < 0.05, "{bin}");
            }
            fourier.inverse(&mut spectrum, &mut again);
            assert_close(&again, &plane, 1e-2);
        }
    }
}
