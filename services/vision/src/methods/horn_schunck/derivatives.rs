//! The derivatives of brightness (thesis eqs. 2.29–2.31), made ready for the iteration.

use crate::geometry::SizePx;
use crate::methods::plane::Plane;

/// E_x, E_y and E_t, each divided by √(α² + E_x² + E_y²): with these eqs. 2.36 and 2.37 need no division, since
/// E_x (E_x ū + E_y v̄ + E_t) / (α² + E_x² + E_y²) is a product of two of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Derivatives {
    pub(super) x: Plane,
    pub(super) y: Plane,
    pub(super) t: Plane,
}

impl Derivatives {
    /// From the means of four differences over the cube of two by two pixels and two frames (Fig 2.8).
    pub(super) fn estimate(&mut self, first: &Plane, second: &Plane, alpha: f32) {
        let SizePx { width, height } = first.size();
        for plane in [&mut self.x, &mut self.y, &mut self.t] {
            plane.reset(first.size());
        }
        for i in 0..height {
            let below = (i + 1).min(height - 1);
            let rows = [first.row(i), first.row(below), second.row(i), second.row(below)];
            let (x, y, t) = (self.x.row_mut(i), self.y.row_mut(i), self.t.row_mut(i));
            for j in 0..width as usize {
                let right = (j + 1).min(width as usize - 1);
                // Names: frame k, row i or the one below, column j or the one to the right.
                let [upper, lower, upper_next, lower_next] = rows.map(|row| (row[j], row[right]));
                let e_x = (upper.1 - upper.0)
                    + (lower.1 - lower.0)
                    + (upper_next.1 - upper_next.0)
                    + (lower_next.1 - lower_next.0);
                let e_y = (lower.0 - upper.0)
                    + (lower.1 - upper.1)
                    + (lower_next.0 - upper_next.0)
                    + (lower_next.1 - upper_next.1);
                let e_t = (upper_next.0 - upper.0)
                    + (lower_next.0 - lower.0)
                    + (upper_next.1 - upper.1)
                    + (lower_next.1 - lower.1);
                let (e_x, e_y, e_t) = (e_x / 4.0, e_y / 4.0, e_t / 4.0);
                let square = alpha * alpha + e_x * e_x + e_y * e_y;
                // No gradient and no smoothing: nothing is known here, and nothing changes.
                let factor = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
                (x[j], y[j], t[j]) = (e_x * factor, e_y * factor, e_t * factor);
            }
        }
    }
}
