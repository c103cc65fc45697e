//! Fading a picture towards its edges.

use std::f64::consts::TAU;

use crate::geometry::SizePx;
use crate::methods::fourier::{Fourier, Spectrum};
use crate::methods::plane::Plane;

/// What is done about the picture's edges, which the transform takes to touch each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Taper {
    /// Nothing: for pictures that do continue at the other side.
    None,
    /// The picture fades towards its edges (Hann window).
    #[default]
    Hann,
}

/// The taper's factors along x and along y.
#[derive(Clone, Debug)]
pub(super) struct Fade {
    along_x: Vec<f32>,
    along_y: Vec<f32>,
}

impl Taper {
    fn factors(self, length: u32) -> Vec<f32> {
        match self {
            Self::None => vec![1.0; length as usize],
            Self::Hann => hann(length, 0, length),
        }
    }
}

/// Hann's window over `count` of `length` places, from place `first` on; 0 elsewhere.
fn hann(length: u32, first: u32, count: u32) -> Vec<f32> {
    let factor = |at: u32| {
        let turn = TAU * (f64::from(at) + 0.5) / f64::from(count);
        (0.5 - 0.5 * turn.cos()) as f32
    };
    let inside = |at: u32| at.checked_sub(first).filter(|&at| at < count);
    (0..length).map(|at| inside(at).map_or(0.0, factor)).collect()
}

/// Fades of the first picture and of the second around what both show when the second is shifted by (dx, dy).
pub(super) fn overlap(size: SizePx, (dx, dy): (i64, i64)) -> [Fade; 2] {
    let along = |length: u32, shift: i64| {
        let beyond = shift.unsigned_abs() as u32;
        let (first, second) = if shift < 0 { (beyond, 0) } else { (0, beyond) };
        [first, second].map(|first| hann(length, first, length - beyond))
    };
    let ([first_x, second_x], [first_y, second_y]) = (along(size.width, dx), along(size.height, dy));
    [Fade { along_x: first_x, along_y: first_y }, Fade { along_x: second_x, along_y: second_y }]
}

impl Fade {
    pub(super) fn new(size: SizePx, taper: Taper) -> Self {
        Self { along_x: taper.factors(size.width), along_y: taper.factors(size.height) }
    }

    /// The spectrum of a faded picture. The mean of what is seen is taken away first, or the fading itself would be seen.
    pub(super) fn transform(&self, fourier: &mut Fourier, plane: &Plane, spectrum: &mut Spectrum) {
        let mean = self.mean(plane);
        let fill = |y: usize, row: &mut [f32]| {
            let values = plane.row(y as u32).iter().zip(&self.along_x);
            // Of a large picture the squares of bins would not fit.
            let along_y = self.along_y[y] / plane.values().len() as f32;
            for (faded, (value, factor)) in row.iter_mut().zip(values) {
                *faded = (value - mean) * factor * along_y;
            }
        };
        fourier.forward_rows(plane.height() as usize, plane.width() as usize, fill, spectrum);
    }

    fn mean(&self, plane: &Plane) -> f32 {
        let (mut total, mut weight) = (0.0, 0.0);
        for (y, &along_y) in (0..plane.height()).zip(&self.along_y) {
            let mut sums = (0.0, 0.0);
            for (value, factor) in plane.row(y).iter().zip(&self.along_x) {
                sums = (sums.0 + value * factor, sums.1 + factor);
            }
            total += f64::from(sums.0) * f64::from(along_y);
            weight += f64::from(sums.1) * f64::from(along_y);
        }
        if weight > 0.0 { (total / weight) as f32 } else { 0.0 }
    }
}
