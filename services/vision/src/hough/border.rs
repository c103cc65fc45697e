//! The border pixels that vote, and the pieces of border that lie on a line.

use std::f64::consts::PI;

use crate::outline::Outline;

use super::votes::{ANGLES, Reach};

/// A border pixel votes this many bins to either side of its local normal: chords of eight pixels are good to ±7°, more
/// where a side begins to bend.
const ANGLE_REACH: usize = 18;
/// Half the chord that gives the local direction, in border pixels.
const CHORD: isize = 4;
/// Outlines shorter than this have no local direction: their pixels vote for every angle.
const SHORTEST_WITH_DIRECTION: usize = 20;
/// A border pixel lies on a line when it is at most this far from it, in mask pixels.
const ON_LINE: f64 = 1.0;
/// Border pixels off the line that do not yet end a segment.
const LARGEST_GAP: usize = 2;

/// A piece of border: the number of its first pixel, and how many pixels it spans.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    pub(super) first: usize,
    pub(super) span: usize,
}

/// The pixels of an outline around their middle, an array for each property: every question to all of them is a plain
/// loop over arrays.
#[derive(Clone, Debug, Default)]
pub(super) struct Border {
    /// The middle of the outline's bounding box.
    origin: (i32, i32),
    half_diagonal: f64,
    pixels: Vec<(i32, i32)>,
    x: Vec<f64>,
    y: Vec<f64>,
    /// The first angle bin that each pixel votes in; all vote in as many.
    first_angle: Vec<u16>,
    angles: u16,
    /// 1 for pixels that belong to no segment yet.
    free: Vec<u8>,
    /// 1 for pixels on the line that was asked about last.
    on_line: Vec<u8>,
}

impl Border {
    /// Takes the pixels of `outline`, all free.
    pub(super) fn follow(&mut self, outline: &Outline) {
        let pixels = outline.pixels();
        let (mut low, mut high) = (pixels[0], pixels[0]);
        for &(x, y) in pixels {
            low = (low.0.min(x), low.1.min(y));
            high = (high.0.max(x), high.1.max(y));
        }
        self.origin = (low.0.midpoint(high.0), low.1.midpoint(high.1));
        self.half_diagonal = f64::from(high.0 - low.0).hypot(f64::from(high.1 - low.1)) / 2.0;
        let origin = self.origin;
        self.pixels.clear();
        self.pixels.extend(pixels.iter().map(|&(x, y)| (x - origin.0, y - origin.1)));
        self.x.clear();
        self.x.extend(self.pixels.iter().map(|&(x, _)| f64::from(x)));
        self.y.clear();
        self.y.extend(self.pixels.iter().map(|&(_, y)| f64::from(y)));
        let directed = pixels.len() >= SHORTEST_WITH_DIRECTION;
        self.angles = if directed { 2 * ANGLE_REACH + 1 } else { ANGLES } as u16;
        self.first_angle.clear();
        let first = |at| if directed { first_angle(outline, at) } else { 0 };
        self.first_angle.extend((0..pixels.len()).map(first));
        self.free.clear();
        self.free.resize(pixels.len(), 1);
        self.on_line.resize(pixels.len(), 0);
    }

    /// The largest distance of a pixel from the origin.
    pub(super) fn half_diagonal(&self) -> f64 {
        self.half_diagonal
    }

    /// Where pixel number `at` is, from the origin, and the angles that it votes for.
    pub(super) fn pixel(&self, at: usize) -> ((i32, i32), Reach) {
        (self.pixels[at], Reach { first: self.first_angle[at].into(), bins: self.angles.into() })
    }

    /// A place in the mask, from the origin.
    pub(super) fn centred(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x - f64::from(self.origin.0), y - f64::from(self.origin.1))
    }

    /// Whether pixel `at` belongs to no segment yet.
    pub(super) fn is_free(&self, at: usize) -> bool {
        self.free[at] == 1
    }

    /// Whether pixel `at` was free, which it is no more.
    pub(super) fn take(&mut self, at: usize) -> bool {
        std::mem::replace(&mut self.free[at], 0) == 1
    }

    /// The longest piece of free border along a line (ρ from the origin).
    pub(super) fn longest_piece(&mut self, theta_rad: f64, rho: f64) -> Piece {
        self.mark_line(theta_rad, rho);
        let on_line = self.on_line.as_slice();
        let count = on_line.len();
        // Begin behind a gap, so that no piece is cut where the numbering begins.
        let off = |at: usize| (0..=LARGEST_GAP).all(|back| on_line[(at + count - back) % count] == 0);
        let begin = (0..count).find(|&at| on_line[at] == 0 && off(at)).unwrap_or(0);
        let (mut best, mut piece) = (Piece::default(), None::<(usize, usize)>);
        let (before, after) = on_line.split_at(begin);
        for (at, _) in (begin..).zip(after.iter().chain(before)).filter(|&(_, &on_line)| on_line == 1) {
            let (first, last) = match piece {
                Some((first, last)) if at - last <= LARGEST_GAP + 1 => (first, at),
                _ => (at, at),
            };
            piece = Some((first, last));
            if last + 1 - first > best.span {
                best = Piece { first, span: last + 1 - first };
            }
        }
        Piece { first: best.first % count, ..best }
    }

    /// Marks the free pixels near the line that vote for its angle.
    fn mark_line(&mut self, theta_rad: f64, rho: f64) {
        let (sin, cos) = theta_rad.sin_cos();
        let around = ANGLES as u16;
        let angle = (theta_rad * ANGLES as f64 / PI) as u16 % around;
        let angles = self.angles;
        for ((on_line, &free), &first) in self.on_line.iter_mut().zip(&self.free).zip(&self.first_angle) {
            let ahead = angle + around - first;
            let ahead = if ahead >= around { ahead - around } else { ahead };
            *on_line = free & u8::from(ahead < angles);
        }
        for ((on_line, &x), &y) in self.on_line.iter_mut().zip(&self.x).zip(&self.y) {
            *on_line &= u8::from((x * cos + y * sin - rho).abs() <= ON_LINE);
        }
    }
}

/// The first angle bin that border pixel `at` votes in.
fn first_angle(outline: &Outline, at: usize) -> u16 {
    let (ax, ay) = outline.pixel_after(at, -CHORD);
    let (bx, by) = outline.pixel_after(at, CHORD);
    let normal_rad = f64::from(bx - ax).atan2(f64::from(ay - by)).rem_euclid(PI);
    let middle = (normal_rad * ANGLES as f64 / PI) as usize;
    ((middle + ANGLES - ANGLE_REACH) % ANGLES) as u16
}
