//! Step 10 of thesis 4.0.3: the Hough transform of a component's outline, and the straight pieces in it.
//!
//! A line is x cos θ + y sin θ = ρ with θ in 0..π. Bins are half a degree and one mask pixel wide, taken by `floor`, and
//! a line that leaves the range of θ at one end comes in at the other with ρ negated. Each border pixel votes only for
//! directions near its local normal. Segments are taken greedily: the fullest bin, the longest gapless piece of border
//! that lies on it, refined by total least squares; its pixels take their votes back, and so on.

use std::f64::consts::PI;
use std::ops::Range;

use crate::outline::Outline;

/// Bins of θ: half a degree each.
const ANGLES: usize = 360;
/// A border pixel votes this many bins to either side of its local normal: chords of eight pixels are good to ±7°, more
/// where a side begins to bend.
const ANGLE_REACH: usize = 18;
/// Half the chord that gives the local direction, in border pixels.
const CHORD: isize = 4;
/// Outlines shorter than this have no local direction: their pixels vote for every angle.
const SHORTEST_WITH_DIRECTION: usize = 20;
/// Binary places of the tables of sine and cosine.
const FRACTION_BITS: u32 = 14;
/// A border pixel lies on a line when it is at most this far from it, in mask pixels.
const ON_LINE: f64 = 1.0;
/// Border pixels off the line that do not yet end a segment.
const LARGEST_GAP: usize = 2;
/// How often a segment's line is fitted again to the longer piece that it then covers.
const REFINEMENTS: usize = 3;
/// The shortest segment: this many mask pixels, and this part of the outline.
const SHORTEST: f64 = 5.0;
const SHORTEST_SHARE: f64 = 0.05;
/// No outline is asked for more.
const MOST_SEGMENTS: usize = 24;

/// A straight piece of an outline, in mask pixels, running clockwise around the component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutlineSegment {
    /// Where it begins: column, row, by pixel number.
    pub from: (f64, f64),
    /// Where it ends.
    pub to: (f64, f64),
    /// Number of its first pixel in the outline.
    pub first: usize,
    /// Border pixels that it spans, those in gaps included.
    pub span: usize,
    /// Votes of its bin when it was taken.
    pub votes: u32,
}

impl OutlineSegment {
    /// Length in mask pixels.
    #[must_use]
    pub fn length(&self) -> f64 {
        (self.to.0 - self.from.0).hypot(self.to.1 - self.from.1)
    }

    /// Direction of travel, in radians within −π..π from the x axis towards y (clockwise on the screen).
    #[must_use]
    pub fn heading_rad(&self) -> f64 {
        (self.to.1 - self.from.1).atan2(self.to.0 - self.from.0)
    }
}

/// Marks an angle whose votes have changed since its fullest bin was looked for.
const STALE: i16 = -1;

/// Neighbouring angle bins, counted around the half circle.
#[derive(Clone, Copy, Debug)]
struct Reach {
    first: usize,
    bins: usize,
}

impl Reach {
    /// The bins as ranges: one, or two where they pass the end of 0..π.
    fn ranges(self) -> [Range<usize>; 2] {
        let end = self.first + self.bins;
        [self.first..end.min(ANGLES), 0..end.saturating_sub(ANGLES)]
    }

    fn contains(self, angle: usize) -> bool {
        (angle + ANGLES - self.first) % ANGLES < self.bins
    }
}

/// The transform with its memory.
#[derive(Clone, Debug)]
pub struct Hough {
    /// cos θ and sin θ of the middle of each bin, times 2^[`FRACTION_BITS`].
    table: Vec<(i32, i32)>,
    /// Votes, θ-major. No bin gets more than the pixels of a straight line.
    votes: Vec<i16>,
    /// For each angle the votes of its fullest bin, or [`STALE`].
    fullest: Vec<i16>,
    /// Bins of ρ.
    distances: usize,
    /// Added to ⌊ρ⌋ to give its bin.
    distance_offset: i32,
    /// Subtracted from every pixel, so that ρ stays small.
    origin: (i32, i32),
    /// For each border pixel the angle bins that it votes in.
    reach: Vec<Reach>,
    taken: Vec<bool>,
    segments: Vec<OutlineSegment>,
}

impl Default for Hough {
    fn default() -> Self {
        let scale = f64::from(1 << FRACTION_BITS);
        let entry = |bin| {
            let (sin, cos) = theta_of(bin).sin_cos();
            ((cos * scale).round() as i32, (sin * scale).round() as i32)
        };
        Self {
            table: (0..ANGLES).map(entry).collect(),
            votes: Vec::new(),
            fullest: vec![STALE; ANGLES],
            distances: 0,
            distance_offset: 0,
            origin: (0, 0),
            reach: Vec::new(),
            taken: Vec::new(),
            segments: Vec::new(),
        }
    }
}

impl Hough {
    /// The straight pieces of `outline`, in the order in which it passes them.
    pub fn segments(&mut self, outline: &Outline) -> &[OutlineSegment] {
        self.segments.clear();
        let shortest = SHORTEST.max(SHORTEST_SHARE * outline.length());
        if (outline.pixels().len() as f64) >= shortest {
            self.prepare(outline);
            for at in 0..outline.pixels().len() {
                self.vote(outline, at, 1);
            }
            self.take_segments(outline, shortest);
            self.segments.sort_unstable_by_key(|segment| segment.first);
        }
        &self.segments
    }

    /// Lays out the bins around the outline's middle and finds each pixel's reach.
    fn prepare(&mut self, outline: &Outline) {
        let pixels = outline.pixels();
        let (mut low, mut high) = (pixels[0], pixels[0]);
        for &(x, y) in pixels {
            low = (low.0.min(x), low.1.min(y));
            high = (high.0.max(x), high.1.max(y));
        }
        self.origin = (low.0.midpoint(high.0), low.1.midpoint(high.1));
        let half_diagonal = f64::from(high.0 - low.0).hypot(f64::from(high.1 - low.1)) / 2.0;
        self.distance_offset = half_diagonal.ceil() as i32 + 2;
        self.distances = 2 * self.distance_offset as usize + 1;
        self.votes.clear();
        self.votes.resize(ANGLES * self.distances, 0);
        self.fullest.fill(0);
        self.taken.clear();
        self.taken.resize(pixels.len(), false);
        self.reach.clear();
        self.reach.extend((0..pixels.len()).map(|at| reach_of(outline, at)));
    }

    /// Adds (1) or takes back (-1) the votes of one border pixel.
    fn vote(&mut self, outline: &Outline, at: usize, count: i16) {
        let (x, y) = self.centred(outline.pixels()[at]);
        for angles in self.reach[at].ranges() {
            self.fullest[angles.clone()].fill(STALE);
            let rows = self.votes[angles.start * self.distances..].chunks_exact_mut(self.distances);
            for (&(cos, sin), row) in self.table[angles].iter().zip(rows) {
                // The shift takes the floor.
                let distance = ((x * cos + y * sin) >> FRACTION_BITS) + self.distance_offset;
                row[distance as usize] += count;
            }
        }
    }

    /// The first of the fullest bins, and its votes.
    fn fullest_bin(&mut self) -> (usize, i16) {
        let rows = self.votes.chunks_exact(self.distances);
        for (fullest, row) in self.fullest.iter_mut().zip(rows).filter(|(fullest, _)| **fullest == STALE) {
            *fullest = row.iter().copied().fold(0, i16::max);
        }
        let most = self.fullest.iter().copied().fold(0, i16::max);
        let angle = self.fullest.iter().position(|&votes| votes == most).unwrap_or(0);
        let row = &self.votes[angle * self.distances..][..self.distances];
        let distance = row.iter().position(|&votes| votes == most).unwrap_or(0);
        (angle * self.distances + distance, most)
    }

    fn centred(&self, (x, y): (i32, i32)) -> (i32, i32) {
        (x - self.origin.0, y - self.origin.1)
    }

    /// Takes the fullest bins' segments until none is long enough.
    fn take_segments(&mut self, outline: &Outline, shortest: f64) {
        let mut left = outline.pixels().len();
        for _ in 0..MOST_SEGMENTS {
            let (bin, votes) = self.fullest_bin();
            // A side of that many pixels leaves at least half of them in the fullest of the bins it spreads over.
            if (left as f64) < shortest || f64::from(votes) < shortest / 2.0 {
                return;
            }
            let (first, span, segment) = self.refined(outline, bin, votes as u32);
            for at in (first..first + span).map(|at| at % outline.pixels().len()) {
                if !std::mem::replace(&mut self.taken[at], true) {
                    self.vote(outline, at, -1);
                    left -= 1;
                }
            }
            if span == 0 {
                self.votes[bin] = 0;
                self.fullest[bin / self.distances] = STALE;
            } else if segment.length() >= shortest {
                self.segments.push(segment);
            }
        }
    }

    /// The segment that the line of `bin` leads to: bins are coarse, so the line is fitted to what lies on it, and again.
    fn refined(&self, outline: &Outline, bin: usize, votes: u32) -> (usize, usize, OutlineSegment) {
        let (angle, distance) = (bin / self.distances, bin % self.distances);
        let rho = distance as f64 - f64::from(self.distance_offset) + 0.5;
        let mut piece = self.longest_piece(outline, theta_of(angle), rho);
        let mut segment = fitted(outline, piece.0, piece.1, votes);
        for _ in 0..REFINEMENTS {
            let theta = (segment.heading_rad() + PI / 2.0).rem_euclid(PI);
            let (x, y) =
                (segment.from.0 - f64::from(self.origin.0), segment.from.1 - f64::from(self.origin.1));
            let longer = self.longest_piece(outline, theta, x * theta.cos() + y * theta.sin());
            if longer.1 <= piece.1 {
                break;
            }
            piece = longer;
            segment = fitted(outline, piece.0, piece.1, votes);
        }
        (piece.0, piece.1, segment)
    }

    /// The longest piece of border along a line (ρ from the origin of the bins): number of its first pixel, and pixels.
    fn longest_piece(&self, outline: &Outline, theta: f64, rho: f64) -> (usize, usize) {
        let (sin, cos) = theta.sin_cos();
        let angle = (theta * ANGLES as f64 / PI) as usize;
        let pixels = outline.pixels();
        let on_line = |at: usize| {
            let (x, y) = self.centred(pixels[at]);
            !self.taken[at]
                && self.reach[at].contains(angle)
                && (f64::from(x) * cos + f64::from(y) * sin - rho).abs() <= ON_LINE
        };
        let count = pixels.len();
        // Begin behind a gap, so that no piece is cut where the numbering begins.
        let begin =
            (0..count).find(|&at| (0..=LARGEST_GAP).all(|back| !on_line((at + count - back) % count)));
        let begin = begin.unwrap_or(0);
        let (mut best, mut piece) = ((0, 0), None::<(usize, usize)>);
        for at in (begin..begin + count).filter(|&at| on_line(at % count)) {
            piece = match piece {
                Some((first, last)) if at - last <= LARGEST_GAP + 1 => Some((first, at)),
                _ => Some((at, at)),
            };
            if let Some((first, last)) = piece
                && last + 1 - first > best.1
            {
                best = (first, last + 1 - first);
            }
        }
        (best.0 % count, best.1)
    }
}

/// The middle of an angle bin, in radians.
fn theta_of(angle: usize) -> f64 {
    (angle as f64 + 0.5) * PI / ANGLES as f64
}

/// The angle bins that border pixel `at` votes in.
fn reach_of(outline: &Outline, at: usize) -> Reach {
    if outline.pixels().len() < SHORTEST_WITH_DIRECTION {
        return Reach { first: 0, bins: ANGLES };
    }
    let (ax, ay) = outline.pixel_after(at, -CHORD);
    let (bx, by) = outline.pixel_after(at, CHORD);
    let normal = f64::from(bx - ax).atan2(f64::from(ay - by)).rem_euclid(PI);
    let middle = (normal * ANGLES as f64 / PI) as usize;
    Reach { first: (middle + ANGLES - ANGLE_REACH) % ANGLES, bins: 2 * ANGLE_REACH + 1 }
}

/// The straight line that fits a piece of border best (total least squares), between the feet of its end pixels.
fn fitted(outline: &Outline, first: usize, span: usize, votes: u32) -> OutlineSegment {
    let mut pixels = (0..span).map(|ahead| {
        let (x, y) = outline.pixel_after(first, ahead as isize);
        (f64::from(x), f64::from(y))
    });
    let count = span.max(1) as f64;
    let mean = pixels.clone().fold((0.0, 0.0), |mean, (x, y)| (mean.0 + x / count, mean.1 + y / count));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in pixels.clone().map(|(x, y)| (x - mean.0, y - mean.1)) {
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let (sin, cos) = ((2.0 * xy).atan2(xx - yy) / 2.0).sin_cos();
    let foot = |(x, y): (f64, f64)| {
        let along = (x - mean.0) * cos + (y - mean.1) * sin;
        (mean.0 + along * cos, mean.1 + along * sin)
    };
    let end = |pixel: Option<(f64, f64)>| foot(pixel.unwrap_or(mean));
    OutlineSegment { from: end(pixels.next()), to: end(pixels.next_back()), first, span, votes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bitmask::BitMask;
    use crate::drawn::{outline, polygon};

    fn segments(mask: &BitMask) -> Vec<OutlineSegment> {
        Hough::default().segments(&outline(mask)).to_vec()
    }

    #[test]
    fn sides_of_polygons_are_found_at_any_turn() {
        for (sides, turn) in [3, 4, 5, 6].into_iter().flat_map(|sides| (0..30).map(move |turn| (sides, turn)))
        {
            let turn_rad = f64::from(turn) * 0.0731;
            let found = segments(&polygon(sides, 50.0, turn_rad));
            let length = 2.0 * 50.0 * (PI / f64::from(sides)).sin();
            let long: Vec<_> = found.iter().filter(|segment| segment.length() > 0.7 * length).collect();
            assert_eq!(long.len(), sides as usize, "{sides} sides turned by {turn_rad}: {found:?}");
            for segment in long {
                let step = 2.0 * PI / f64::from(sides);
                // Clockwise travel has the outward normal to its left.
                let off = (segment.heading_rad() - PI / 2.0 - turn_rad).rem_euclid(step);
                let off = off.min(step - off).to_degrees();
                assert!(off < 1.5, "{sides} sides turned by {turn_rad}: {off}° off");
            }
        }
    }

    #[test]
    fn a_speck_has_no_sides() {
        let mut mask = BitMask::new(9, 9);
        mask.set_run(3, 3, 5);
        assert_eq!(segments(&mask), []);
    }
}
