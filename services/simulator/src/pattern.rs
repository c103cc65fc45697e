//! Random structure for surfaces.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

const LATTICE: usize = 64;

/// Smooth random values over a square that repeats: value noise in several octaves.
#[derive(Debug)]
pub(crate) struct Clouds {
    lattice: Vec<f32>,
}

impl Clouds {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Pcg32::seed_from_u64(seed);
        Self { lattice: (0..LATTICE * LATTICE).map(|_| random.random_range(-1.0..1.0)).collect() }
    }

    /// One octave, −1..1, smooth; it repeats every `period` units, a divisor of 64.
    fn octave(&self, u: f64, v: f64, period: usize) -> f64 {
        let (column, row) = (u.floor(), v.floor());
        let ease = |t: f64| t * t * (3.0 - 2.0 * t);
        let (s, t) = (ease(u - column), ease(v - row));
        let wrap = |at: f64| (at as i64).rem_euclid(period as i64) as usize;
        let (left, top) = (wrap(column), wrap(row));
        let (right, bottom) = ((left + 1) % period, (top + 1) % period);
        let at = |column: usize, row: usize| f64::from(self.lattice[row * LATTICE + column]);
        let above = at(left, top) + (at(right, top) - at(left, top)) * s;
        let below = at(left, bottom) + (at(right, bottom) - at(left, bottom)) * s;
        above + (below - above) * t
    }

    /// `octaves` octaves, the first with `cells` (a power of two) over the square's side, each further one finer by
    /// two and weaker by half; about −1..1. `u` and `v` run over 0..1 for the whole square, and repeat.
    pub(crate) fn at(&self, u: f64, v: f64, cells: usize, octaves: u32) -> f64 {
        (0..octaves)
            .map(|octave| {
                let scale = (cells << octave) as f64;
                self.octave(u * scale, v * scale, (cells << octave).min(LATTICE)) / f64::from(1 << octave)
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clouds_repeat_without_a_seam() {
        let clouds = Clouds::new(5);
        for cells in [8, 64] {
            for v in [0.0, 0.3, 0.99] {
                let (before, after) = (clouds.at(1.0 - 1e-9, v, cells, 3), clouds.at(0.0, v, cells, 3));
                assert!((before - after).abs() < 1e-4, "{before} {after}");
            }
        }
    }
}
