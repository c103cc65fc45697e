//! The bins of the Hough transform and what is counted in them.

use std::f64::consts::PI;
use std::ops::Range;

/// Bins of θ: half a degree each.
pub(super) const ANGLES: usize = 360;
/// Binary places of the tables of sine and cosine.
const FRACTION_BITS: u32 = 14;

/// Marks an angle whose votes have changed since its fullest bin was looked for.
const STALE: i16 = -1;

/// Neighbouring angle bins, counted around the half circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub(super) first: usize,
    pub(super) bins: usize,
}

impl Reach {
    /// The bins as ranges: one, or two where they pass the end of 0..π.
    fn ranges(self) -> [Range<usize>; 2] {
        let end = self.first + self.bins;
        [self.first..end.min(ANGLES), 0..end.saturating_sub(ANGLES)]
    }
}

/// A bin, and its votes when it was looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bin {
    angle: usize,
    distance: usize,
    pub(super) votes: u16,
}

/// Votes for lines around an origin.
#[derive(Clone, Debug)]
pub(super) struct Votes {
    /// cos θ and sin θ of the middle of each bin, times 2^[`FRACTION_BITS`].
    table: Vec<(i32, i32)>,
    /// θ-major. No bin gets more than the pixels of a straight line.
    votes: Vec<i16>,
    /// For each angle the votes of its fullest bin, or [`STALE`].
    fullest: Vec<i16>,
    /// Bins of ρ.
    distances: usize,
    /// Added to ⌊ρ⌋ to give its bin.
    distance_offset: i32,
}

impl Default for Votes {
    fn default() -> Self {
        let scale = f64::from(1 << FRACTION_BITS);
        let entry = |bin| {
            let (sin, cos) = theta_rad_of(bin).sin_cos();
            ((cos * scale).round() as i32, (sin * scale).round() as i32)
        };
        Self {
            table: (0..ANGLES).map(entry).collect(),
            votes: Vec::new(),
            fullest: vec![STALE; ANGLES],
            distances: 0,
            distance_offset: 0,
        }
    }
}

impl Votes {
    /// Empty bins for lines through pixels at most this far from the origin.
    pub(super) fn lay_out(&mut self, most_distance: f64) {
        self.distance_offset = most_distance.ceil() as i32 + 2;
        self.distances = 2 * self.distance_offset as usize + 1;
        self.votes.clear();
        self.votes.resize(ANGLES * self.distances, 0);
        self.fullest.fill(0);
    }

    /// Adds (1) or takes back (-1) the votes of a pixel for every line through it within `reach`.
    pub(super) fn add(&mut self, (x, y): (i32, i32), reach: Reach, count: i16) {
        for angles in reach.ranges() {
            self.fullest[angles.clone()].fill(STALE);
            let rows = self.votes[angles.start * self.distances..].chunks_exact_mut(self.distances);
            for (&(cos, sin), row) in self.table[angles].iter().zip(rows) {
                // The shift takes the floor.
                let distance = ((x * cos + y * sin) >> FRACTION_BITS) + self.distance_offset;
                row[distance as usize] += count;
            }
        }
    }

    /// The first of the fullest bins.
    pub(super) fn fullest_bin(&mut self) -> Bin {
        let rows = self.votes.chunks_exact(self.distances);
        for (fullest, row) in self.fullest.iter_mut().zip(rows).filter(|(fullest, _)| **fullest == STALE) {
            *fullest = row.iter().copied().fold(0, i16::max);
        }
        let most = self.fullest.iter().copied().fold(0, i16::max);
        let angle = self.fullest.iter().position(|&votes| votes == most).unwrap_or(0);
        let row = &self.votes[angle * self.distances..][..self.distances];
        let distance = row.iter().position(|&votes| votes == most).unwrap_or(0);
        Bin { angle, distance, votes: most.unsigned_abs() }
    }

    /// Empties a bin.
    pub(super) fn forget(&mut self, bin: Bin) {
        self.votes[bin.angle * self.distances + bin.distance] = 0;
        self.fullest[bin.angle] = STALE;
    }

    /// θ in radians and ρ of the line in the middle of a bin.
    pub(super) fn line(&self, bin: Bin) -> (f64, f64) {
        (theta_rad_of(bin.angle), bin.distance as f64 - f64::from(self.distance_offset) + 0.5)
    }
}

/// The middle of an angle bin.
fn theta_rad_of(angle: usize) -> f64 {
    (angle as f64 + 0.5) * PI / ANGLES as f64
}
