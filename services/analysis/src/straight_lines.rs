//! The strongest straight lines of a whole picture: Sobel's edges, Hough transform, and back (thesis 2.5, 2.6).

use vision::methods::gradient::{Operator, gradient};
use vision::methods::hough::{Peaks, Votes};
use vision::methods::{Border, HoughTransform, Intensity, Plane};
use vision::{BitMask, Frame, Segment};

/// An edge's magnitude is at least this part of the largest one.
const EDGE_PART: f32 = 0.25;
/// Pieces of a line are joined over gaps of at most so many pixels, and shorter ones are left out.
const LONGEST_GAP_PX: u32 = 3;
const SHORTEST_PX: u32 = 8;

/// The strongest lines of a picture.
pub(crate) struct StraightLines {
    /// Sobel's magnitude.
    pub(crate) magnitude: Plane,
    /// The accumulator.
    pub(crate) votes: Votes,
    /// The pieces of the strongest lines.
    pub(crate) segments: Vec<Segment>,
}

impl StraightLines {
    /// The `most` strongest lines.
    pub(crate) fn of(frame: &Frame, most: usize) -> Self {
        let plane = Plane::of(frame, Intensity::Luma);
        let magnitude = gradient(&plane, Operator::Sobel, Border::Nearest).magnitude();
        let threshold = EDGE_PART * magnitude.maximum().map_or(0.0, |(_, _, most)| most);
        let mut edges = BitMask::new(magnitude.width(), magnitude.height());
        for y in 0..magnitude.height() {
            for (x, _) in (0..).zip(magnitude.row(y)).filter(|(_, value)| **value > threshold) {
                edges.set(x, y);
            }
        }
        let votes = HoughTransform::default().votes(&edges);
        let peaks = Peaks { most_lines: most, least_votes: SHORTEST_PX, ..Peaks::default() };
        let lines = votes.lines(&peaks);
        let segments =
            lines.iter().flat_map(|line| line.segments(&edges, LONGEST_GAP_PX, SHORTEST_PX)).collect();
        Self { magnitude, votes, segments }
    }
}
