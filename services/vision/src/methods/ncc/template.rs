//! What is searched for: the template at one scale.

use crate::frame::Frame;
use crate::geometry::SizePx;
use crate::methods::Border;
use crate::methods::fourier::{Fourier, Spectrum};
use crate::methods::interpolate::Interpolation;
use crate::methods::low_pass::gaussian;
use crate::methods::plane::{Intensity, Plane};

use super::{Colours, LARGEST_SIDE, NccError};

/// A template at one scale, its mean taken away.
#[derive(Clone, Debug)]
pub(super) struct Template {
    pub(super) size: SizePx,
    pub(super) scale: f32,
    /// h − h̄ of each channel.
    deviations: Vec<Plane>,
    /// √Σ(h − h̄)² over all channels.
    pub(super) norm: f64,
    /// Those of the deviations, conjugated, once their size is known.
    pub(super) spectra: Vec<Spectrum>,
}

impl Template {
    pub(super) fn new(template: &Frame, colours: Colours, scale: f32) -> Result<Self, NccError> {
        let intensities: &[Intensity] = match colours {
            Colours::Grey => &[Intensity::Luma],
            Colours::Rgb => &[Intensity::Red, Intensity::Green, Intensity::Blue],
        };
        let side = |length: u32| (f64::from(length) * f64::from(scale)).round() as u32;
        let size = SizePx { width: side(template.width()), height: side(template.height()) };
        if size.width == 0 || size.height == 0 {
            return Err(NccError::Empty { scale });
        }
        if size.width.max(size.height) > LARGEST_SIDE {
            return Err(NccError::TooLarge { scale, side: size.width.max(size.height) });
        }
        let deviations: Vec<Plane> = intensities
            .iter()
            .map(|&intensity| without_mean(scaled(Plane::of(template, intensity), size, scale)))
            .collect();
        let squares = deviations.iter().flat_map(Plane::values).map(|&value| f64::from(value).powi(2));
        let norm = squares.sum::<f64>().sqrt();
        // Resampling a flat template leaves rounding errors.
        if norm < 1e-3 * f64::from(size.width * size.height).sqrt() {
            return Err(NccError::Flat { scale });
        }
        Ok(Self { size, scale, deviations, norm, spectra: Vec::new() })
    }

    /// Makes the spectra, unless they are there.
    pub(super) fn transform(&mut self, fourier: &mut Fourier) {
        if self.spectra.is_empty() {
            self.spectra = self.deviations.iter().map(|plane| conjugate_spectrum(fourier, plane)).collect();
        }
    }

    /// Makes `product` the spectrum of the numerator of eq. 2.22, summed over channels. The window's mean drops out of it
    /// because the deviations add up to zero.
    pub(super) fn correlate(&self, frame: &[Spectrum], product: &mut Spectrum) {
        for (channel, (frame, template)) in frame.iter().zip(&self.spectra).enumerate() {
            if channel == 0 {
                product.set_product(frame, template);
            } else {
                product.add_product(frame, template);
            }
        }
    }
}

/// The plane at its new size; smoothed first where it shrinks, since interpolation averages nothing.
fn scaled(plane: Plane, size: SizePx, scale: f32) -> Plane {
    if size == plane.size() {
        return plane;
    }
    let sigma_px = 0.5 * (1.0 / (scale * scale) - 1.0).max(0.0).sqrt();
    Interpolation::Bilinear.resized(&gaussian(&plane, sigma_px, Border::Nearest), size)
}

fn without_mean(mut plane: Plane) -> Plane {
    let total: f64 = plane.values().iter().map(|&value| f64::from(value)).sum();
    let mean = total / plane.values().len() as f64;
    for value in plane.values_mut() {
        *value = (f64::from(*value) - mean) as f32;
    }
    plane
}

fn conjugate_spectrum(fourier: &mut Fourier, plane: &Plane) -> Spectrum {
    let mut spectrum = Spectrum::default();
    fourier.forward(plane, &mut spectrum);
    for bin in spectrum.bins_mut() {
        *bin = bin.conj();
    }
    spectrum
}
