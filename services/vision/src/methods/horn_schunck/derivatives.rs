//! The derivatives of brightness (thesis eqs. 2.29–2.31), made ready for the iteration.

use super::lines::{Piece, load, pieces};
use crate::mask::{Lanes, Work};
use crate::methods::plane::Plane;

/// E_x, E_y and E_t, each divided by √(α² + E_x² + E_y²): with these eqs. 2.36 and 2.37 need no division, since
/// E_x (E_x ū + E_y v̄ + E_t) / (α² + E_x² + E_y²) is a product of two of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Derivatives {
    /// For every piece of every row the three of them; 0 beyond the row's end.
    rows: Vec<[Piece; 3]>,
    pieces: usize,
    scratch: [Vec<f32>; 3],
}

impl Derivatives {
    /// From the means of four differences over the cube of two by two pixels and two frames (Fig 2.8).
    pub(super) fn estimate(&mut self, first: &Plane, second: &Plane, alpha: f32, lanes: Lanes) {
        let width = first.width() as usize;
        self.pieces = pieces(width);
        self.rows.clear();
        self.rows.resize(self.pieces * first.height() as usize, Default::default());
        self.scratch.iter_mut().for_each(|row| row.resize(width, 0.0));
        lanes.run(Estimate { derivatives: self, first, second, alpha_squared: alpha * alpha });
    }

    /// The pieces of a row.
    #[inline(always)]
    pub(super) fn row(&self, y: usize) -> &[[Piece; 3]] {
        &self.rows[y * self.pieces..][..self.pieces]
    }
}

struct Estimate<'a> {
    derivatives: &'a mut Derivatives,
    first: &'a Plane,
    second: &'a Plane,
    alpha_squared: f32,
}

impl Work for Estimate<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { derivatives: Derivatives { rows, pieces, scratch }, first, second, alpha_squared } = self;
        let height = first.height();
        let mut pieces_of = vec![Piece::default(); *pieces];
        for (y, out) in (0..height).zip(rows.chunks_exact_mut(*pieces)) {
            let below = (y + 1).min(height - 1);
            let cube = [first.row(y), first.row(below), second.row(y), second.row(below)];
            row(cube, scratch, alpha_squared);
            for (number, scratch) in scratch.iter().enumerate() {
                load(scratch, &mut pieces_of);
                out.iter_mut().zip(&pieces_of).for_each(|(out, piece)| out[number] = *piece);
            }
        }
    }
}

/// One row, from row i and the one below it of frame k and of frame k + 1.
#[inline(always)]
fn row(cube: [&[f32]; 4], out: &mut [Vec<f32>; 3], alpha_squared: f32) {
    let last = cube[0].len() - 1;
    let [here, here_below, next, next_below] = cube.map(|row| &row[..last]);
    let [right, right_below, next_right, next_right_below] = cube.map(|row| &row[1..last + 1]);
    let [x, y, t] = out;
    let (x, y, t) = (&mut x[..last + 1], &mut y[..last + 1], &mut t[..last + 1]);
    for j in 0..last {
        let (left, right) = (
            [here[j], here_below[j], next[j], next_below[j]],
            [right[j], right_below[j], next_right[j], next_right_below[j]],
        );
        (x[j], y[j], t[j]) = divided(differences(left, right), alpha_squared);
    }
    let edge = cube.map(|row| row[last]);
    (x[last], y[last], t[last]) = divided(differences(edge, edge), alpha_squared);
}

/// Eqs. 2.29–2.31 from column j and column j + 1, each: row i, row i + 1, the same of the next frame.
#[inline(always)]
fn differences(left: [f32; 4], right: [f32; 4]) -> (f32, f32, f32) {
    let [a, b, c, d] = left;
    let [e, f, g, h] = right;
    let x = ((e - a) + (f - b)) + ((g - c) + (h - d));
    let y = ((b - a) + (f - e)) + ((d - c) + (h - g));
    let t = ((c - a) + (d - b)) + ((g - e) + (h - f));
    (x / 4.0, y / 4.0, t / 4.0)
}

#[inline(always)]
fn divided((x, y, t): (f32, f32, f32), alpha_squared: f32) -> (f32, f32, f32) {
    let square = alpha_squared + x * x + y * y;
    // No gradient and no smoothing: nothing is known here, and nothing changes.
    let factor = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
    (x * factor, y * factor, t * factor)
}
