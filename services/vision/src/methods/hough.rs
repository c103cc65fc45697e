//! The Hough transform for straight lines (thesis 2.6, eqs. 2.18, 2.19) and its inverse.
//!
//! Every set pixel votes for all lines through its middle, ρ = x cos θ + y sin θ with θ in 0..π. Unlike `vision::hough`,
//! which follows one outline, this takes whole edge pictures, as the thesis's Figs 2.5, 3.2 and 3.6 do.

mod inverse;

use std::f64::consts::PI;
use std::num::NonZeroU16;

use super::plane::Plane;
use crate::bitmask::{BitMask, Run};
use crate::geometry::{Segment, SizePx};

/// The cells that the parameter space is divided into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HoughTransform {
    /// Cells of θ over 0..π; cell k is θ = kπ / angles. 180 are whole degrees.
    pub angles: NonZeroU16,
}

impl Default for HoughTransform {
    /// Half degrees.
    fn default() -> Self {
        Self { angles: const { NonZeroU16::new(360).unwrap() } }
    }
}

/// A straight line with what speaks for it, in frame pixels (corner origin).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// Distance from the frame's corner, negative where the line passes it at the other side.
    pub rho_px: f32,
    /// Direction of the line's normal in 0..π, from the x axis towards y.
    pub theta_rad: f32,
    /// Pixels that voted for it.
    pub votes: u32,
}

/// The votes of a picture: cells of θ by cells of ρ, one pixel wide, whose middle is a whole number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Votes {
    angles: u32,
    /// Cells of ρ: from −`reach` to `reach`, measured from the middle of the first pixel.
    reach: u32,
    votes: Vec<u32>,
}

/// Which cells' lines are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peaks {
    /// Fewer votes are no line.
    pub least_votes: u32,
    /// No more lines than this.
    pub most_lines: usize,
    /// A line silences the cells that are at most so many cells of θ …
    pub near_angles: u32,
    /// … and so many pixels of ρ away.
    pub near_rho_px: u32,
}

impl Default for Peaks {
    fn default() -> Self {
        Self { least_votes: 20, most_lines: 100, near_angles: 8, near_rho_px: 8 }
    }
}

impl HoughTransform {
    /// The votes of the set pixels of `mask`.
    #[must_use]
    pub fn votes(&self, mask: &BitMask) -> Votes {
        let angles = u32::from(self.angles.get());
        let (across, down) = (mask.width().saturating_sub(1), mask.height().saturating_sub(1));
        let reach = f64::from(across).hypot(f64::from(down)).ceil() as u32;
        let cells = 2 * reach as usize + 1;
        let mut votes = Votes { angles, reach, votes: vec![0; angles as usize * cells] };
        let mut runs: Vec<Run> = Vec::new();
        mask.touched_rows().for_each(|y| mask.append_runs(y, &mut runs));
        for (row, angle) in votes.votes.chunks_exact_mut(cells).zip(0..) {
            let (sin, cos) = theta_rad(angle, angles).sin_cos();
            for run in &runs {
                // Half a cell is added, so that flooring rounds.
                let start = f64::from(run.y) * sin + f64::from(reach) + 0.5;
                for x in run.x_start..run.x_end {
                    row[(start + f64::from(x) * cos) as usize] += 1;
                }
            }
        }
        votes
    }
}

impl Votes {
    /// The accumulator as a picture: a row for each cell of θ, a column for each of ρ (Figs 2.4, 2.5 b).
    #[must_use]
    pub fn plane(&self) -> Plane {
        let size = SizePx { width: 2 * self.reach + 1, height: self.angles };
        Plane::from_fn(size, |rho, angle| self.cell(angle, rho) as f32)
    }

    fn cell(&self, angle: u32, rho: u32) -> u32 {
        self.votes[angle as usize * (2 * self.reach as usize + 1) + rho as usize]
    }

    /// The lines of the fullest cells, the fullest first.
    #[must_use]
    pub fn lines(&self, peaks: &Peaks) -> Vec<Line> {
        let cells = 2 * self.reach + 1;
        let mut order: Vec<(u32, u32)> = (0..self.votes.len() as u32)
            .map(|at| (self.votes[at as usize], at))
            .filter(|&(votes, _)| votes >= peaks.least_votes.max(1))
            .collect();
        order.sort_unstable_by_key(|&(votes, at)| (std::cmp::Reverse(votes), at));
        let mut silenced = vec![false; self.votes.len()];
        let mut lines = Vec::new();
        for (votes, at) in order {
            if lines.len() >= peaks.most_lines {
                break;
            }
            if !silenced[at as usize] {
                let cell = (at / cells, at % cells);
                self.silence(cell, peaks, &mut silenced);
                lines.push(self.line(cell, votes));
            }
        }
        lines
    }

    /// Marks the cells near one. At the end of 0..π a line comes in again with ρ negated.
    fn silence(&self, (angle, rho): (u32, u32), peaks: &Peaks, silenced: &mut [bool]) {
        let (angles, cells) = (i64::from(self.angles), 2 * self.reach + 1);
        let near_angles = i64::from(peaks.near_angles.min(self.angles));
        for ahead in -near_angles..=near_angles {
            let other = i64::from(angle) + ahead;
            let rho = if (0..angles).contains(&other) { rho } else { cells - 1 - rho };
            let row = other.rem_euclid(angles) as usize * cells as usize;
            let (first, last) =
                (rho.saturating_sub(peaks.near_rho_px), rho.saturating_add(peaks.near_rho_px));
            silenced[row + first as usize..=row + last.min(cells - 1) as usize].fill(true);
        }
    }

    fn line(&self, (angle, rho): (u32, u32), votes: u32) -> Line {
        let theta_rad = theta_rad(angle, self.angles);
        let (sin, cos) = theta_rad.sin_cos();
        let rho_px = f64::from(rho) - f64::from(self.reach) + (sin + cos) / 2.0;
        Line { rho_px: rho_px as f32, theta_rad: theta_rad as f32, votes }
    }
}

impl Line {
    /// The part of the line that crosses a picture of that size; `None` where it passes it by.
    #[must_use]
    pub fn across(&self, size: SizePx) -> Option<Segment> {
        inverse::across(self, size)
    }

    /// The inverse transform: those pieces of the line on which pixels of `mask` are set, at most a pixel beside it, with
    /// no gap longer than `longest_gap_px` and at least `shortest_px` long.
    #[must_use]
    pub fn segments(&self, mask: &BitMask, longest_gap_px: u32, shortest_px: u32) -> Vec<Segment> {
        inverse::segments(self, mask, longest_gap_px, shortest_px)
    }
}

fn theta_rad(angle: u32, angles: u32) -> f64 {
    f64::from(angle) * PI / f64::from(angles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mask_of(width: u32, height: u32, points: &[(u32, u32)]) -> BitMask {
        let mut mask = BitMask::new(width, height);
        points.iter().for_each(|&(x, y)| mask.set(x % width, y % height));
        mask
    }

    #[test]
    fn a_drawn_line_is_found_once() {
        let points: Vec<_> = (0..60).map(|x| (x, 10 + x / 2)).collect();
        let mask = mask_of(64, 48, &points);
        let lines = HoughTransform::default().votes(&mask).lines(&Peaks::default());
        assert_eq!(lines.len(), 1, "{lines:?}");
        // y = x / 2 + 10: its normal points down and to the left.
        let expected_rad = (2.0_f32).atan2(-1.0);
        assert!((lines[0].theta_rad - expected_rad).abs() < 0.02, "{lines:?}");
        let segments = lines[0].segments(&mask, 3, 20);
        assert_eq!(segments.len(), 1);
        assert!((segments[0].length_px() - 66.0).abs() < 4.0, "{segments:?}");
    }

    #[test]
    fn a_line_at_the_end_of_the_angles_is_not_found_twice() {
        // Nearly upright: neighbours vote at 0° and, with ρ negated, just below 180°.
        let points: Vec<_> = (0..40).map(|y| (20 + y / 39, y)).collect();
        let lines = HoughTransform::default().votes(&mask_of(41, 40, &points)).lines(&Peaks::default());
        assert_eq!(lines.len(), 1, "{lines:?}");
    }

    #[test]
    fn nothing_votes_in_an_empty_picture() {
        for (width, height) in [(0, 0), (0, 5), (1, 1)] {
            let votes = HoughTransform::default().votes(&BitMask::new(width, height));
            assert_eq!(votes.lines(&Peaks::default()), []);
        }
        let one = HoughTransform::default().votes(&mask_of(1, 1, &[(0, 0)]));
        assert_eq!(one.plane().maximum().map(|(_, _, votes)| votes), Some(1.0));
    }

    proptest! {
        #[test]
        fn each_pixel_votes_once_an_angle_for_a_line_through_it(
            width in 1u32..40, height in 1u32..40,
            points in proptest::collection::vec((0u32..40, 0u32..40), 0..12),
        ) {
            let mask = mask_of(width, height, &points);
            let votes = HoughTransform { angles: NonZeroU16::new(90).unwrap() }.votes(&mask);
            let mut expected = vec![0; votes.votes.len()];
            for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
                for angle in (0..90).filter(|_| mask.get(x, y)) {
                    let (sin, cos) = theta_rad(angle, 90).sin_cos();
                    let rho = (f64::from(x) * cos + f64::from(y) * sin + f64::from(votes.reach) + 0.5).floor();
                    expected[angle as usize * (2 * votes.reach as usize + 1) + rho as usize] += 1;
                }
            }
            let different = votes.votes.iter().zip(&expected).filter(|(ours, reference)| ours != reference).count();
            // Sums in another order may round a pixel on the boundary into the next cell.
            prop_assert!(different <= 2 * mask.count() as usize, "{different} cells differ");
            prop_assert_eq!(votes.votes.iter().map(|&v| u64::from(v)).sum::<u64>(), 90 * mask.count());
        }
    }
}
