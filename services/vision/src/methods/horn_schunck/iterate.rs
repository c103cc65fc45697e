//! The iteration of thesis eqs. 2.36 and 2.37.

use super::Flow;
use super::derivatives::Derivatives;

/// Applies the two equations `iterations` times to `flow`, with `other` as memory.
pub(super) fn iterate(derivatives: &Derivatives, iterations: u32, flow: &mut Flow, other: &mut Flow) {
    let size = flow.u.size();
    other.u.reset(size);
    other.v.reset(size);
    for _ in 0..iterations {
        for y in 0..size.height {
            for x in 0..size.width {
                let near = |at: u32, length: u32| [at.saturating_sub(1), at, (at + 1).min(length - 1)];
                let (columns, rows) = (near(x, size.width), near(y, size.height));
                // Eqs. 2.33, 2.34: 1/6 of the four at the sides and 1/12 of the four at the corners.
                let mean = |plane: &super::Plane| {
                    let row = |y: u32| {
                        let [left, middle, right] = columns.map(|x| plane.get(x, y));
                        (left + right) + 2.0 * middle
                    };
                    ((row(rows[0]) + row(rows[2])) + 2.0 * row(rows[1]) - 4.0 * plane.get(x, y)) / 12.0
                };
                let (u, v) = (mean(&flow.u), mean(&flow.v));
                let (e_x, e_y) = (derivatives.x.get(x, y), derivatives.y.get(x, y));
                let error = e_x * u + e_y * v + derivatives.t.get(x, y);
                other.u.row_mut(y)[x as usize] = u - e_x * error;
                other.v.row_mut(y)[x as usize] = v - e_y * error;
            }
        }
        std::mem::swap(flow, other);
    }
}
