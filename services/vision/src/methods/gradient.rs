//! Brightness gradients (thesis 2.5): Sobel (eqs. 2.14, 2.15), Prewitt (eqs. 2.16, 2.17) and Roberts.
//!
//! x runs along rows here. The thesis's ∇x, eq. 2.14, differentiates down the columns, as in texts whose x is the row: it
//! is our `y`. Both derivatives are positive where the picture grows brighter to the right, or downwards.

use super::border::Border;
use super::low_pass::separable;
use super::plane::Plane;

/// Which weights the differences get. None is divided by its weights: a step of one level gives 4, 3 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Operator {
    /// Differences over two pixels, weighted 1, 2, 1.
    #[default]
    Sobel,
    /// Differences over two pixels, weighted 1, 1, 1.
    Prewitt,
    /// Differences along both diagonals of 2 × 2 pixels: `x` is that towards the lower right, `y` towards the lower left.
    Roberts,
}

/// Two derivatives at each pixel (eq. 2.12).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gradient {
    /// ∂f/∂x, in levels times the operator's weights.
    pub x: Plane,
    /// ∂f/∂y.
    pub y: Plane,
}

impl Gradient {
    /// √(Gx² + Gy²) (eq. 2.13).
    #[must_use]
    pub fn magnitude(&self) -> Plane {
        let mut magnitude = self.x.clone();
        for (x, &y) in magnitude.values_mut().iter_mut().zip(self.y.values()) {
            *x = (*x * *x + y * y).sqrt();
        }
        magnitude
    }
}

/// The gradient of `plane`.
#[must_use]
pub fn gradient(plane: &Plane, operator: Operator, border: Border) -> Gradient {
    const DIFFERENCE: [f32; 3] = [-1.0, 0.0, 1.0];
    let across = match operator {
        Operator::Sobel => [1.0, 2.0, 1.0],
        Operator::Prewitt => [1.0; 3],
        Operator::Roberts => return roberts(plane, border),
    };
    Gradient {
        x: separable(plane, &DIFFERENCE, &across, border),
        y: separable(plane, &across, &DIFFERENCE, border),
    }
}

/// f(x+1, y+1) − f(x, y) and f(x, y+1) − f(x+1, y).
fn roberts(plane: &Plane, border: Border) -> Gradient {
    let read = |x: Option<usize>, y: Option<usize>| x.zip(y).map_or(0.0, |(x, y)| plane.row(y as u32)[x]);
    let after = |at: u32, length| border.pixel(i64::from(at) + 1, length);
    let diagonal = |x: u32, y: u32| read(after(x, plane.width()), after(y, plane.height())) - plane.get(x, y);
    let other = |x: u32, y: u32| {
        read(Some(x as usize), after(y, plane.height())) - read(after(x, plane.width()), Some(y as usize))
    };
    Gradient { x: Plane::from_fn(plane.size(), diagonal), y: Plane::from_fn(plane.size(), other) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SizePx;
    use crate::methods::convolve::{Extent, convolve};
    use crate::methods::reference::{any_plane, assert_close};
    use proptest::prelude::*;

    #[test]
    fn a_ramp_has_one_slope() {
        let ramp = Plane::from_fn(SizePx { width: 6, height: 5 }, |x, y| (3 * x + 5 * y) as f32);
        for (operator, x, y) in
            [(Operator::Sobel, 24.0, 40.0), (Operator::Prewitt, 18.0, 30.0), (Operator::Roberts, 8.0, 2.0)]
        {
            let slope = gradient(&ramp, operator, Border::Nearest);
            assert_eq!((slope.x.get(2, 2), slope.y.get(2, 2)), (x, y), "{operator:?}");
        }
    }

    proptest! {
        #[test]
        fn they_are_the_convolutions_of_the_thesis(plane in any_plane(10)) {
            for (operator, middle) in [(Operator::Sobel, 2.0), (Operator::Prewitt, 1.0)] {
                // Eqs. 2.15 and 2.17, then 2.14 and 2.16.
                let x = Plane::new(3, 3, vec![1.0, 0.0, -1.0, middle, 0.0, -middle, 1.0, 0.0, -1.0]).unwrap();
                let y = Plane::new(3, 3, vec![1.0, middle, 1.0, 0.0, 0.0, 0.0, -1.0, -middle, -1.0]).unwrap();
                let slope = gradient(&plane, operator, Border::Zero);
                assert_close(&slope.x, &convolve(&plane, &x, Extent::Same), 0.01);
                assert_close(&slope.y, &convolve(&plane, &y, Extent::Same), 0.01);
            }
        }
    }
}
