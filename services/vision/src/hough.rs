//! Step 10 of thesis 4.0.3: the Hough transform of a component's outline, and the straight pieces in it.
//!
//! A line is x cos θ + y sin θ = ρ with θ in 0..π. Bins are half a degree and one mask pixel wide, taken by `floor`, and
//! a line that leaves the range of θ at one end comes in at the other with ρ negated. Each border pixel votes only for
//! directions near its local normal. Segments are taken greedily: the fullest bin, the longest gapless piece of border
//! that lies on it, refined by total least squares; its pixels take their votes back, and so on.

mod border;
mod votes;

use std::f64::consts::PI;

use crate::outline::Outline;

use border::{Border, Piece};
use votes::{Bin, Votes};

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

/// The transform with its memory.
#[derive(Clone, Debug, Default)]
pub struct Hough {
    votes: Votes,
    border: Border,
    segments: Vec<OutlineSegment>,
}

impl Hough {
    /// The straight pieces of `outline`, in the order in which it passes them.
    pub fn segments(&mut self, outline: &Outline) -> &[OutlineSegment] {
        self.segments.clear();
        let shortest = SHORTEST.max(SHORTEST_SHARE * outline.length());
        if (outline.pixels().len() as f64) >= shortest {
            self.border.follow(outline);
            self.votes.lay_out(self.border.half_diagonal());
            for at in 0..outline.pixels().len() {
                let (pixel, reach) = self.border.pixel(at);
                self.votes.add(pixel, reach, 1);
            }
            self.take_segments(outline, shortest);
            self.segments.sort_unstable_by_key(|segment| segment.first);
        }
        &self.segments
    }

    /// Takes the fullest bins' segments until none is long enough.
    fn take_segments(&mut self, outline: &Outline, shortest: f64) {
        let mut left = outline.pixels().len();
        for _ in 0..MOST_SEGMENTS {
            let bin = self.votes.fullest_bin();
            // A side of that many pixels leaves at least half of them in the fullest of the bins it spreads over.
            if f64::from(bin.votes) < shortest / 2.0 {
                return;
            }
            let segment = self.refined(outline, bin);
            if segment.span > 0 && segment.length() >= shortest {
                self.segments.push(segment);
            }
            let pixels = segment.first..segment.first + segment.span;
            left -= pixels.clone().filter(|at| self.border.is_free(at % outline.pixels().len())).count();
            if (left as f64) < shortest {
                return;
            }
            for at in pixels.map(|at| at % outline.pixels().len()) {
                if self.border.take(at) {
                    let (pixel, reach) = self.border.pixel(at);
                    self.votes.add(pixel, reach, -1);
                }
            }
            if segment.span == 0 {
                self.votes.forget(bin);
            }
        }
    }

    /// The segment that the line of `bin` leads to: bins are coarse, so the line is fitted to what lies on it, and again.
    fn refined(&mut self, outline: &Outline, bin: Bin) -> OutlineSegment {
        let (theta_rad, rho) = self.votes.line(bin);
        let mut piece = self.border.longest_piece(theta_rad, rho);
        let mut segment = fitted(outline, piece, bin.votes);
        for _ in 0..REFINEMENTS {
            let theta_rad = (segment.heading_rad() + PI / 2.0).rem_euclid(PI);
            let (x, y) = self.border.centred(segment.from);
            let longer = self.border.longest_piece(theta_rad, x * theta_rad.cos() + y * theta_rad.sin());
            if longer.span <= piece.span {
                break;
            }
            piece = longer;
            segment = fitted(outline, piece, bin.votes);
        }
        segment
    }
}

/// The straight line that fits a piece of border best (total least squares), between the feet of its end pixels.
fn fitted(outline: &Outline, Piece { first, span }: Piece, votes: u16) -> OutlineSegment {
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
    OutlineSegment { from: end(pixels.next()), to: end(pixels.next_back()), first, span, votes: votes.into() }
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
