//! Where a landmark will be in the next frame (thesis 4.0.6).
//!
//! Four methods share one record of the past. The thesis prints equation 4.1 with a sign that extrapolates backwards;
//! `Printed` reproduces it for comparison, `ConstantVelocity` is what the text describes. The covariance is the
//! Kalman filter's whichever method places the centre, so a gate can be drawn around each of them.

mod fixes;
mod kalman;

pub use fixes::Fixes;
pub use kalman::{Axis, Kalman};

use crate::geometry::PointPx;
use crate::outcome::Prediction;
use crate::timestamp::Timestamp;

/// The interval assumed when capture times stand still or go backwards, s.
pub const NOMINAL_INTERVAL_S: f64 = 1.0 / 30.0;
/// Gaps longer than this count as this long, s: what was known of the motion is void by then.
pub const MAX_INTERVAL_S: f64 = 5.0;

/// How the next place is told from the earlier ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PredictionMethod {
    /// Equation 4.1 as printed; for comparison only.
    Printed,
    /// Where it was last.
    Persistence,
    /// Straight on at the speed of the last two sightings.
    ConstantVelocity,
    /// A Kalman filter on position, velocity, log area and its rate.
    #[default]
    Kalman,
}

impl PredictionMethod {
    /// Every method.
    pub const ALL: [Self; 4] = [Self::Printed, Self::Persistence, Self::ConstantVelocity, Self::Kalman];

    /// The name used on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Printed => "printed",
            Self::Persistence => "persistence",
            Self::ConstantVelocity => "constant-velocity",
            Self::Kalman => "kalman",
        }
    }
}

/// One measured place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fix {
    /// When.
    pub captured_at: Timestamp,
    /// Centre.
    pub centroid: PointPx,
    /// Area.
    pub area_px2: f32,
}

impl Fix {
    fn is_finite(&self) -> bool {
        self.centroid.x.is_finite() && self.centroid.y.is_finite() && self.area_px2.is_finite()
    }
}

/// The record of one object's motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Predictor {
    /// How the next place is told.
    pub method: PredictionMethod,
    /// The filter, at the time of the last fix.
    pub kalman: Kalman,
    /// The last fixes, newest first.
    pub fixes: Fixes,
}

impl Predictor {
    /// A record that begins with `fix`.
    #[must_use]
    pub fn new(method: PredictionMethod, fix: Fix) -> Self {
        Self { method, kalman: Kalman::new(fix), fixes: Fixes::from_iter([fix]) }
    }

    /// The prior for a frame captured at `at`.
    #[must_use]
    pub fn predict(&self, at: Timestamp) -> Prediction {
        let prior = self.kalman.predict(at);
        let Some(last) = self.fixes.first() else { return prior };
        let stepped = |newer: &Fix, older: &Fix, steps: f64| {
            let ahead =
                |from: f32, new: f32, old: f32| from + ((f64::from(new) - f64::from(old)) * steps) as f32;
            Prediction {
                centroid: PointPx {
                    x: ahead(last.centroid.x, newer.centroid.x, older.centroid.x),
                    y: ahead(last.centroid.y, newer.centroid.y, older.centroid.y),
                },
                area_px2: ahead(last.area_px2, newer.area_px2, older.area_px2).max(0.0),
                ..prior
            }
        };
        let here = Prediction { centroid: last.centroid, area_px2: last.area_px2, ..prior };
        match (self.method, &*self.fixes) {
            (PredictionMethod::Kalman, _) => prior,
            (PredictionMethod::ConstantVelocity, [newer, older, ..]) => {
                let apart_s = interval_s(older.captured_at, newer.captured_at);
                stepped(newer, older, interval_s(newer.captured_at, at) / apart_s)
            }
            (PredictionMethod::Printed, [_, second, third]) => stepped(third, second, 1.0),
            _ => here,
        }
    }

    /// Takes a fix into account. One that is not finite is ignored.
    pub fn update(&mut self, fix: Fix) {
        if !fix.is_finite() {
            return;
        }
        self.kalman.update(fix);
        self.fixes.push_newest(fix);
    }
}

/// Seconds from `earlier` to `later`, as the filters count them: nominal where the clock did not advance, bounded
/// where it leapt.
#[must_use]
pub fn interval_s(earlier: Timestamp, later: Timestamp) -> f64 {
    let elapsed_s = later.seconds_since(earlier);
    if elapsed_s > 0.0 { elapsed_s.clamp(1e-3, MAX_INTERVAL_S) } else { NOMINAL_INTERVAL_S }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fix(k: i64, x: f32) -> Fix {
        Fix {
            captured_at: Timestamp::from_nanos(k * 33_333_333),
            centroid: PointPx::new(x, 2.0 * x),
            area_px2: 100.0,
        }
    }

    fn predicted_x(method: PredictionMethod) -> f32 {
        let mut predictor = Predictor::new(method, fix(0, 0.0));
        predictor.update(fix(1, 3.0));
        predictor.update(fix(2, 5.0));
        predictor.predict(Timestamp::from_nanos(3 * 33_333_333)).centroid.x
    }

    #[test]
    fn each_method_steps_as_its_formula_says() {
        assert!((predicted_x(PredictionMethod::Persistence) - 5.0).abs() < 1e-4);
        assert!((predicted_x(PredictionMethod::ConstantVelocity) - 7.0).abs() < 1e-4);
        // Equation 4.1 as printed: x_k + (x_{k-2} − x_{k-1}) = 5 + (0 − 3).
        assert!((predicted_x(PredictionMethod::Printed) - 2.0).abs() < 1e-4);
    }

    #[test]
    fn constant_velocity_counts_time_not_frames() {
        let mut predictor = Predictor::new(PredictionMethod::ConstantVelocity, fix(0, 0.0));
        predictor.update(fix(1, 3.0));
        let later = predictor.predict(Timestamp::from_nanos(3 * 33_333_333));
        assert!((later.centroid.x - 9.0).abs() < 1e-3);
    }
}
