//! The iteration of thesis eqs. 2.36 and 2.37, many times over without going to memory for each.
//!
//! One iteration needs of the one before only the row itself and its neighbours. So several run at once, each a row behind
//! the one before: when a row comes in, iteration 1 computes the row above it, iteration 2 the row above that, and so on.
//! Each keeps three rows, which stay in the cache. The numbers are those of one iteration after the other, bit for bit.

use super::Flow;
use super::derivatives::Derivatives;
use super::lines::{LANES, Piece, load, pieces, store};
use crate::mask::{Lanes, Work};

/// The memory that the rows of the iterations which run at once should take, so that they stay in a core's own cache.
const CACHE_BYTES: usize = 512 << 10;
/// What an iteration keeps and reads, in numbers a column: three rows of u and v, and one of each derivative.
const NUMBERS_PER_COLUMN: usize = 9;

/// Rows that are kept of each iteration.
const KEPT: usize = 3;

/// u and v of sixteen neighbouring pixels.
type Pair = [Piece; 2];

/// The rows of all iterations that run at once.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// For each iteration, and the input before the first, [`KEPT`] rows. Each row has a piece more at either end; there
    /// its outermost values are repeated, so that every pixel has neighbours.
    rows: Vec<Pair>,
    width: usize,
    stride: usize,
    row: Vec<Piece>,
}

impl Rows {
    /// Applies the two equations `iterations` times to `flow`, which must have pixels.
    pub(super) fn iterate(
        &mut self,
        derivatives: &Derivatives,
        iterations: u32,
        flow: &mut Flow,
        lanes: Lanes,
    ) {
        self.width = flow.u.width() as usize;
        self.stride = pieces(self.width) + 2;
        self.row.resize(pieces(self.width), Piece::default());
        let most = (CACHE_BYTES / (NUMBERS_PER_COLUMN * size_of::<f32>() * LANES * self.stride)).max(2);
        let mut left = iterations as usize;
        while left > 0 {
            let depth = left.min(most);
            self.rows.clear();
            self.rows.resize((depth + 1) * KEPT * self.stride, Pair::default());
            lanes.run(Pass { rows: self, derivatives, depth, flow: &mut *flow });
            left -= depth;
        }
    }
}

/// `depth` iterations over the whole picture.
struct Pass<'a> {
    rows: &'a mut Rows,
    derivatives: &'a Derivatives,
    depth: usize,
    flow: &'a mut Flow,
}

impl Work for Pass<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { rows, derivatives, depth, flow } = self;
        let height = flow.u.height() as usize;
        for step in 0..height + depth {
            if step < height {
                rows.load(step, flow);
            }
            for iteration in 1..=depth.min(step) {
                let y = step - iteration;
                if y < height {
                    rows.compute(iteration, y, height, derivatives.row(y));
                }
            }
            if let Some(y) = step.checked_sub(depth) {
                rows.store(depth, y, flow);
            }
        }
    }
}

impl Rows {
    /// Where a row of an iteration begins.
    #[inline(always)]
    fn start(&self, iteration: usize, y: usize) -> usize {
        (iteration * KEPT + y % KEPT) * self.stride
    }

    #[inline(always)]
    fn load(&mut self, y: usize, flow: &Flow) {
        let start = self.start(0, y);
        for (number, plane) in [&flow.u, &flow.v].into_iter().enumerate() {
            load(plane.row(y as u32), &mut self.row);
            let kept = self.rows[start + 1..].iter_mut().zip(&self.row);
            kept.for_each(|(pair, piece)| pair[number] = *piece);
        }
        repeat_ends(&mut self.rows[start..start + self.stride], self.width);
    }

    #[inline(always)]
    fn store(&mut self, iteration: usize, y: usize, flow: &mut Flow) {
        let start = self.start(iteration, y);
        for (number, plane) in [&mut flow.u, &mut flow.v].into_iter().enumerate() {
            let kept = self.row.iter_mut().zip(&self.rows[start + 1..]);
            kept.for_each(|(piece, pair)| *piece = pair[number]);
            store(&self.row, plane.row_mut(y as u32));
        }
    }

    /// Row `y` of an iteration from three rows of the one before.
    #[inline(always)]
    fn compute(&mut self, iteration: usize, y: usize, height: usize, slopes: &[[Piece; 3]]) {
        let stride = self.stride;
        let near = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| self.start(iteration - 1, y));
        let to = self.start(iteration, y);
        let (before, after) = self.rows.split_at_mut(iteration * KEPT * stride);
        let after = &mut after[to - iteration * KEPT * stride..][..stride];
        update(near.map(|at| &before[at..at + stride]), slopes, after);
        repeat_ends(after, self.width);
    }
}

/// One row of eqs. 2.36 and 2.37. The rows have a piece more than `slopes` at either end.
#[inline(always)]
fn update([above, here, below]: [&[Pair]; 3], slopes: &[[Piece; 3]], after: &mut [Pair]) {
    let count = slopes.len();
    let (above, here, below) = (&above[..count + 2], &here[..count + 2], &below[..count + 2]);
    let after = &mut after[..count + 2];
    let mut left = sum_columns(&above[0], &here[0], &below[0]);
    let mut middle = sum_columns(&above[1], &here[1], &below[1]);
    for (at, [e_x, e_y, e_t]) in slopes.iter().enumerate() {
        let right = sum_columns(&above[at + 2], &here[at + 2], &below[at + 2]);
        let u = mean(&left[0], &middle[0], &right[0], &here[at + 1][0]);
        let v = mean(&left[1], &middle[1], &right[1], &here[at + 1][1]);
        let error = Piece::each(|k| e_x.0[k] * u.0[k] + e_y.0[k] * v.0[k] + e_t.0[k]);
        after[at + 1][0] = Piece::each(|k| u.0[k] - e_x.0[k] * error.0[k]);
        after[at + 1][1] = Piece::each(|k| v.0[k] - e_y.0[k] * error.0[k]);
        (left, middle) = (middle, right);
    }
}

/// The row above, twice the row, and the row below.
#[inline(always)]
fn sum_columns(above: &Pair, here: &Pair, below: &Pair) -> Pair {
    // Not `map`: it would be compiled without the vector instructions of its caller.
    [
        Piece::each(|k| (above[0].0[k] + below[0].0[k]) + 2.0 * here[0].0[k]),
        Piece::each(|k| (above[1].0[k] + below[1].0[k]) + 2.0 * here[1].0[k]),
    ]
}

/// Eqs. 2.33, 2.34: 1/6 of the four pixels at the sides and 1/12 of the four at the corners, from sums down the columns,
/// which weigh all nine 1, 2, 1 by 1, 2, 1, and the pixel itself.
#[inline(always)]
fn mean(left: &Piece, middle: &Piece, right: &Piece, here: &Piece) -> Piece {
    let (left, right) = (middle.behind(left), middle.ahead(right));
    Piece::each(|k| (((left.0[k] + right.0[k]) + 2.0 * middle.0[k]) - 4.0 * here.0[k]) * (1.0 / 12.0))
}

/// Repeats the outermost values of a row of `width` before its first and after its last.
#[inline(always)]
fn repeat_ends(row: &mut [Pair], width: usize) {
    let (last, after) = (LANES + width - 1, LANES + width);
    let first = [row[1][0].0[0], row[1][1].0[0]];
    let last = [row[last / LANES][0].0[last % LANES], row[last / LANES][1].0[last % LANES]];
    for (piece, value) in row[0].iter_mut().zip(first) {
        piece.0[LANES - 1] = value;
    }
    for (piece, value) in row[after / LANES].iter_mut().zip(last) {
        piece.0[after % LANES] = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::plane::Plane;
    use crate::methods::reference::any_plane;
    use proptest::prelude::*;

    /// One iteration after the other, pixel by pixel.
    fn slowly(derivatives: &Derivatives, iterations: u32, flow: &mut Flow) {
        let size = flow.u.size();
        let slope = |x: u32, y: u32, number: usize| {
            derivatives.row(y as usize)[x as usize / LANES][number].0[x as usize % LANES]
        };
        for _ in 0..iterations {
            let average = |plane: &Plane| {
                Plane::from_fn(size, |x, y| {
                    let near = |at: u32, length: u32| [at.saturating_sub(1), at, (at + 1).min(length - 1)];
                    let (columns, rows) = (near(x, size.width), near(y, size.height));
                    let [left, middle, right] = columns.map(|x| {
                        let [above, here, below] = rows.map(|y| plane.get(x, y));
                        (above + below) + 2.0 * here
                    });
                    (((left + right) + 2.0 * middle) - 4.0 * plane.get(x, y)) * (1.0 / 12.0)
                })
            };
            let (u, v) = (average(&flow.u), average(&flow.v));
            let error = Plane::from_fn(size, |x, y| {
                slope(x, y, 0) * u.get(x, y) + slope(x, y, 1) * v.get(x, y) + slope(x, y, 2)
            });
            flow.u = Plane::from_fn(size, |x, y| u.get(x, y) - slope(x, y, 0) * error.get(x, y));
            flow.v = Plane::from_fn(size, |x, y| v.get(x, y) - slope(x, y, 1) * error.get(x, y));
        }
    }

    proptest! {
        #[test]
        fn every_instruction_set_gives_the_iterations_one_by_one_bit_for_bit(
            first in any_plane(40), iterations in 0u32..60, alpha in 1f32..30.0,
        ) {
            prop_assume!(!first.is_empty());
            let second = Plane::from_fn(first.size(), |x, y| first.get((x + 1) % first.width(), y));
            let zeros = Flow { u: Plane::zeros(first.size()), v: Plane::zeros(first.size()) };
            let mut expected: Option<Flow> = None;
            for lanes in Lanes::available() {
                let mut derivatives = Derivatives::default();
                derivatives.estimate(&first, &second, alpha, lanes);
                let expected = expected.get_or_insert_with(|| {
                    let mut flow = zeros.clone();
                    slowly(&derivatives, iterations, &mut flow);
                    flow
                });
                let mut flow = zeros.clone();
                Rows::default().iterate(&derivatives, iterations, &mut flow, lanes);
                prop_assert!(flow == *expected, "{} differs", lanes.name());
            }
        }
    }
}
