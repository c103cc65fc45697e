//! Registration by control points (thesis 2.7.3, spatial domain): the bilinear model of eqs. 2.20 and 2.21.

use super::border::Border;
use super::interpolate::Interpolation;
use super::plane::Plane;
use crate::geometry::{PointPx, SizePx};

/// Fewer pairs do not determine eight coefficients.
pub const LEAST_PAIRS: usize = 4;

/// x = c₁v + c₂w + c₃vw + c₄ and y = c₅v + c₆w + c₇vw + c₈: where a point (v, w) of one picture lies in the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BilinearMap {
    /// c₁ to c₄ (eq. 2.20).
    pub x: [f64; 4],
    /// c₅ to c₈ (eq. 2.21).
    pub y: [f64; 4],
}

/// A point of one picture and where it is in the other, both in frame pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControlPoint {
    /// (v, w).
    pub from: PointPx,
    /// (x, y).
    pub to: PointPx,
}

/// Why control points give no map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ControlPointsError {
    /// Eight coefficients need four pairs.
    #[error("{got} pairs of control points; the bilinear model needs at least {LEAST_PAIRS}")]
    TooFew {
        /// Pairs that were given.
        got: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("pair {number} of the control points is not finite")]
    NotFinite {
        /// Which one, from 0.
        number: usize,
    },
    /// The points leave coefficients open, as when they lie on one line.
    #[error(
        "the control points do not determine the model: spread them out, not all on one line or in one place"
    )]
    Degenerate,
}

impl BilinearMap {
    /// Every point where it is.
    pub const IDENTITY: Self = Self { x: [1.0, 0.0, 0.0, 0.0], y: [0.0, 1.0, 0.0, 0.0] };

    /// The map through four pairs, or with the least sum of squared distances to more.
    ///
    /// # Errors
    /// When the pairs do not determine it.
    pub fn fit(pairs: &[ControlPoint]) -> Result<Self, ControlPointsError> {
        if pairs.len() < LEAST_PAIRS {
            return Err(ControlPointsError::TooFew { got: pairs.len() });
        }
        let finite = |p: PointPx| p.x.is_finite() && p.y.is_finite();
        if let Some(number) = pairs.iter().position(|pair| !finite(pair.from) || !finite(pair.to)) {
            return Err(ControlPointsError::NotFinite { number });
        }
        let frame = Normalisation::of(pairs);
        let mut equations = [[0.0; 6]; 4];
        for pair in pairs {
            let row = terms(frame.normalised(pair.from));
            let right = [f64::from(pair.to.x), f64::from(pair.to.y)];
            for (equation, &factor) in equations.iter_mut().zip(&row) {
                for (sum, value) in equation.iter_mut().zip(row.iter().chain(&right)) {
                    *sum += factor * value;
                }
            }
        }
        let [x, y] = solve(equations, pairs.len()).ok_or(ControlPointsError::Degenerate)?;
        Ok(Self { x: frame.restored(x), y: frame.restored(y) })
    }

    /// Where a point is in the other picture.
    #[must_use]
    pub fn apply(&self, point: PointPx) -> PointPx {
        let row = terms((f64::from(point.x), f64::from(point.y)));
        let sum =
            |coefficients: &[f64; 4]| row.iter().zip(coefficients).map(|(a, b)| a * b).sum::<f64>() as f32;
        PointPx::new(sum(&self.x), sum(&self.y))
    }

    /// The picture of size `size` whose pixel at p is that of `plane` at the place that the map gives p. So the map goes
    /// from the picture that is made to the one that there is.
    #[must_use]
    pub fn warp(&self, plane: &Plane, size: SizePx, interpolation: Interpolation, border: Border) -> Plane {
        Plane::from_fn(size, |x, y| {
            let at = self.apply(PointPx::new(x as f32 + 0.5, y as f32 + 0.5));
            interpolation.sample(plane, at, border)
        })
    }
}

/// v, w, vw, 1.
fn terms((v, w): (f64, f64)) -> [f64; 4] {
    [v, w, v * w, 1.0]
}

/// A shift and a scale that bring the points near to −1..1, where the equations are well conditioned.
struct Normalisation {
    middle: (f64, f64),
    scale: f64,
}

impl Normalisation {
    fn of(pairs: &[ControlPoint]) -> Self {
        let range = |value: fn(&ControlPoint) -> f32| {
            let values = pairs.iter().map(value);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
                (least.min(f64::from(value)), most.max(f64::from(value)))
            })
        };
        let (left, right) = range(|pair| pair.from.x);
        let (top, bottom) = range(|pair| pair.from.y);
        let scale = ((right - left).max(bottom - top) / 2.0).max(f64::MIN_POSITIVE);
        Self { middle: ((left + right) / 2.0, (top + bottom) / 2.0), scale }
    }

    fn normalised(&self, point: PointPx) -> (f64, f64) {
        ((f64::from(point.x) - self.middle.0) / self.scale, (f64::from(point.y) - self.middle.1) / self.scale)
    }

    /// Coefficients for v and w themselves from those for ((v, w) − middle) / scale.
    fn restored(&self, [a, b, c, d]: [f64; 4]) -> [f64; 4] {
        let (v, w) = self.middle;
        let (a, b, c) = (a / self.scale, b / self.scale, c / self.scale / self.scale);
        [a - c * w, b - c * v, c, d - a * v - b * w + c * v * w]
    }
}

/// Four equations with two right sides, by elimination with pivots; `None` where they are as good as singular.
fn solve(mut equations: [[f64; 6]; 4], pairs: usize) -> Option<[[f64; 4]; 2]> {
    let least = 1e-9 * pairs as f64;
    for column in 0..4 {
        let pivot =
            (column..4).max_by(|&a, &b| equations[a][column].abs().total_cmp(&equations[b][column].abs()))?;
        equations.swap(column, pivot);
        if equations[column][column].abs() < least {
            return None;
        }
        let lead = equations[column].map(|value| value / equations[column][column]);
        for (row, equation) in equations.iter_mut().enumerate() {
            let factor = equation[column];
            if row == column {
                *equation = lead;
            } else {
                equation.iter_mut().zip(&lead).for_each(|(value, lead)| *value -= factor * lead);
            }
        }
    }
    Some([equations.map(|equation| equation[4]), equations.map(|equation| equation[5])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pair(v: f32, w: f32, map: &BilinearMap) -> ControlPoint {
        let from = PointPx::new(v, w);
        ControlPoint { from, to: map.apply(from) }
    }

    #[test]
    fn points_that_determine_nothing_are_refused() {
        let same = |from| ControlPoint { from, to: from };
        assert_eq!(BilinearMap::fit(&[]), Err(ControlPointsError::TooFew { got: 0 }));
        assert_eq!(BilinearMap::fit(&[ControlPoint::default(); 9]), Err(ControlPointsError::Degenerate));
        let line: Vec<_> = (0..9_u8).map(|k| same(PointPx::new(f32::from(k), 2.0 * f32::from(k)))).collect();
        assert_eq!(BilinearMap::fit(&line), Err(ControlPointsError::Degenerate));
        let far = [same(PointPx::new(f32::NAN, 0.0)); 4];
        assert_eq!(BilinearMap::fit(&far), Err(ControlPointsError::NotFinite { number: 0 }));
    }

    #[test]
    fn a_picture_is_warped_to_where_the_map_says() {
        let plane = Plane::from_fn(SizePx { width: 8, height: 6 }, |x, y| (10 * y + x) as f32);
        let shift = BilinearMap { x: [1.0, 0.0, 0.0, 2.0], y: [0.0, 1.0, 0.0, 1.0] };
        let warped =
            shift.warp(&plane, SizePx { width: 3, height: 2 }, Interpolation::Bilinear, Border::Zero);
        assert_eq!(warped.values(), [12.0, 13.0, 14.0, 22.0, 23.0, 24.0]);
    }

    proptest! {
        #[test]
        fn the_map_that_made_the_points_is_found_again(
            x in any::<[i8; 4]>(), y in any::<[i8; 4]>(), more in proptest::collection::vec((0f32..640.0, 0f32..480.0), 0..9),
        ) {
            let coefficients = |c: [i8; 4]| {
                let [a, b, c, d] = c.map(f64::from);
                [a / 64.0, b / 64.0, c / 1e5, d]
            };
            let map = BilinearMap { x: coefficients(x), y: coefficients(y) };
            let corners = [(0.0, 0.0), (640.0, 10.0), (5.0, 480.0), (600.0, 470.0)];
            let pairs: Vec<_> = corners.into_iter().chain(more).map(|(v, w)| pair(v, w, &map)).collect();
            let found = BilinearMap::fit(&pairs).unwrap();
            for &ControlPoint { from, to } in &pairs {
                prop_assert!(found.apply(from).distance_px(to) < 1e-2, "{:?} is not {:?}", found.apply(from), to);
            }
        }
    }
}
