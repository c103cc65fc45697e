//! Two-dimensional convolution, in space (thesis eq. 2.5) and by Fourier transforms (eq. 2.8).
//!
//! g(x, y) = Σ f(m, n) h(x − m, y − n), with zeros around the picture. Without the factor 1/MN that eq. 2.5 has: with it,
//! eq. 2.8 would not give the same.

use super::fourier::{Fourier, NoPixels, Spectrum, fast_length};
use super::plane::Plane;
use crate::geometry::{RectPx, SizePx};

/// Which part of a convolution is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extent {
    /// Every place where picture and kernel touch: width + kernel width − 1 columns.
    Full,
    /// The picture's own size: of the full one the part that begins at (kernel − 1) / 2, as in SciPy. (MATLAB begins one
    /// later where the kernel's side is even.)
    #[default]
    Same,
    /// Only where the kernel lies wholly inside.
    Valid,
}

impl Extent {
    /// The part of the full convolution of a picture and a kernel.
    fn of(self, picture: SizePx, kernel: SizePx) -> RectPx {
        let (x, width) = self.side(picture.width, kernel.width);
        let (y, height) = self.side(picture.height, kernel.height);
        RectPx { x, y, width, height }
    }

    /// First place and length along one side.
    fn side(self, picture: u32, kernel: u32) -> (u32, u32) {
        if picture == 0 || kernel == 0 {
            return (0, 0);
        }
        match self {
            Self::Full => (0, picture + kernel - 1),
            Self::Same => ((kernel - 1) / 2, picture),
            Self::Valid => (kernel - 1, (picture + 1).saturating_sub(kernel)),
        }
    }
}

/// The convolution of `plane` with `kernel` in space: width · height · kernel area multiplications.
#[must_use]
pub fn convolve(plane: &Plane, kernel: &Plane, extent: Extent) -> Plane {
    let part = extent.of(plane.size(), kernel.size());
    let mut result = Plane::zeros(SizePx { width: part.width, height: part.height });
    for y in 0..part.height {
        for kernel_y in 0..kernel.height().min(part.y + y + 1) {
            let from = part.y + y - kernel_y;
            if from < plane.height() {
                add_row(result.row_mut(y), plane.row(from), kernel.row(kernel_y), part.x);
            }
        }
    }
    result
}

/// Adds the convolution of one row with one row of the kernel, from place `first` of it on.
fn add_row(sums: &mut [f32], row: &[f32], kernel: &[f32], first: u32) {
    for (kernel_x, &weight) in kernel.iter().enumerate().filter(|&(_, &weight)| weight != 0.0) {
        // Sum x takes pixel x + first − kernel_x.
        let ahead = (first as usize).saturating_sub(kernel_x);
        let behind = kernel_x.saturating_sub(first as usize);
        let sums = sums.iter_mut().skip(behind);
        for (sum, &value) in sums.zip(row.iter().skip(ahead)) {
            *sum += weight * value;
        }
    }
}

/// Convolution with one kernel by Fourier transforms, for pictures of one size; its cost hardly depends on the kernel's.
#[derive(Clone, Debug)]
pub struct FourierConvolution {
    fourier: Fourier,
    kernel: Spectrum,
    spectrum: Spectrum,
    part: RectPx,
}

impl FourierConvolution {
    /// Prepares for pictures of size `picture`.
    ///
    /// # Errors
    /// When picture or kernel has no pixel.
    pub fn new(kernel: &Plane, picture: SizePx, extent: Extent) -> Result<Self, NoPixels> {
        for size in [picture, kernel.size()] {
            if size.width == 0 || size.height == 0 {
                return Err(NoPixels { size });
            }
        }
        let full = Extent::Full.of(picture, kernel.size());
        let size = SizePx { width: fast_length(full.width), height: fast_length(full.height) };
        let (mut fourier, mut spectrum) = (Fourier::new(size)?, Spectrum::default());
        fourier.forward(kernel, &mut spectrum);
        let part = extent.of(picture, kernel.size());
        Ok(Self { fourier, kernel: spectrum, spectrum: Spectrum::default(), part })
    }

    /// The convolution of `plane`, which is cut or filled up with zeros to the size that was prepared for.
    pub fn apply(&mut self, plane: &Plane) -> Plane {
        let Self { fourier, kernel, spectrum, part } = self;
        fourier.forward(plane, spectrum);
        spectrum.multiply(kernel);
        let mut result = Plane::zeros(SizePx { width: part.width, height: part.height });
        let (first, end) = (part.x as usize, (part.x + part.width) as usize);
        fourier.inverse_rows(spectrum, (part.y + part.height) as usize, |y, row| {
            if let Some(y) = (y as u32).checked_sub(part.y) {
                result.row_mut(y).copy_from_slice(&row[first..end]);
            }
        });
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::reference::{any_plane, assert_close};
    use proptest::prelude::*;

    const ALL: [Extent; 3] = [Extent::Full, Extent::Same, Extent::Valid];

    /// Eq. 2.5 written out, without its factor.
    fn slowly(plane: &Plane, kernel: &Plane, extent: Extent) -> Plane {
        let part = extent.of(plane.size(), kernel.size());
        Plane::from_fn(SizePx { width: part.width, height: part.height }, |x, y| {
            let mut sum = 0.0;
            for (n, m) in (0..plane.height()).flat_map(|n| (0..plane.width()).map(move |m| (n, m))) {
                if let (Some(column), Some(row)) = ((x + part.x).checked_sub(m), (y + part.y).checked_sub(n))
                    && column < kernel.width()
                    && row < kernel.height()
                {
                    sum += f64::from(plane.get(m, n)) * f64::from(kernel.get(column, row));
                }
            }
            sum as f32
        })
    }

    proptest! {
        #[test]
        fn space_and_fourier_give_the_sum(plane in any_plane(9), kernel in any_plane(7)) {
            for extent in ALL {
                let slow = slowly(&plane, &kernel, extent);
                assert_close(&convolve(&plane, &kernel, extent), &slow, 2.0);
                match FourierConvolution::new(&kernel, plane.size(), extent) {
                    Ok(mut fourier) => assert_close(&fourier.apply(&plane), &slow, 4.0),
                    Err(NoPixels { .. }) => prop_assert!(plane.is_empty() || kernel.is_empty()),
                }
            }
        }
    }
}
