//! A Kalman filter on position, velocity, log area and its rate, as three independent two-state axes.
//!
//! The motion model is white acceleration (Bar-Shalom, Li, Kirubarajan 2001, section 6.2.2) with a velocity that
//! fades while nothing is seen. Innovations that are steadily larger than the model expects raise its process noise,
//! so a shaking camera opens its own gate. Covariances are bounded on both sides and therefore finite under any input.

use super::{Fix, interval_s};
use crate::geometry::PointPx;
use crate::outcome::Prediction;
use crate::timestamp::Timestamp;

/// Standard deviation of a measured centre, px.
const CENTRE_SIGMA_PX: f64 = 0.9;
/// Standard deviation of a measured log area.
const LOG_AREA_SIGMA: f64 = 0.15;
/// Spectral density of the acceleration of a calm object, px²/s³.
const CENTRE_ACCELERATION: f64 = 600.0;
/// The same of the log area, 1/s³.
const LOG_AREA_ACCELERATION: f64 = 1.0;
/// What an object's velocity may be when it is first seen, px/s.
const FIRST_SPEED_SIGMA: f64 = 60.0;
/// The same of the rate of the log area, 1/s.
const FIRST_RATE_SIGMA: f64 = 1.0;
/// The largest factor by which unrest raises the process noise.
const MAX_UNREST: f64 = 400.0;
/// Velocity fades with this time constant while nothing is seen, s.
const FADE_S: f64 = 1.5;
/// Bounds on every variance.
const VARIANCE: (f64, f64) = (1e-9, 1e8);
/// Bounds on every value and rate.
const LARGEST: f64 = 1e7;

/// One quantity and its rate of change, with their covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Axis {
    /// The quantity.
    pub value: f64,
    /// Its change per second.
    pub rate: f64,
    /// Covariance: value–value, value–rate, rate–rate.
    pub covariance: [f64; 3],
}

impl Axis {
    fn new(value: f64, sigma: f64, rate_sigma: f64) -> Self {
        Self { value, rate: 0.0, covariance: [sigma * sigma, 0.0, rate_sigma * rate_sigma] }
    }

    fn advanced(self, dt_s: f64, density: f64) -> Self {
        // The mean travel of a velocity that fades exponentially.
        let travel_s = FADE_S * (1.0 - (-dt_s / FADE_S).exp());
        let [vv, vr, rr] = self.covariance;
        let covariance = [
            vv + 2.0 * dt_s * vr + dt_s * dt_s * rr + density * dt_s.powi(3) / 3.0,
            vr + dt_s * rr + density * dt_s * dt_s / 2.0,
            rr + density * dt_s,
        ];
        Self { value: self.value + self.rate * travel_s, rate: self.rate, covariance }.bounded()
    }

    fn corrected(self, innovation: f64, noise: f64) -> Self {
        let [vv, vr, rr] = self.covariance;
        let total = vv + noise;
        let (k_value, k_rate) = (vv / total, vr / total);
        Self {
            value: self.value + k_value * innovation,
            rate: self.rate + k_rate * innovation,
            covariance: [(1.0 - k_value) * vv, (1.0 - k_value) * vr, rr - k_rate * vr],
        }
        .bounded()
    }

    fn bounded(self) -> Self {
        let within = |v: f64| if v.is_finite() { v.clamp(-LARGEST, LARGEST) } else { 0.0 };
        let variance = |v: f64| if v.is_finite() { v.clamp(VARIANCE.0, VARIANCE.1) } else { VARIANCE.1 };
        let [vv, vr, rr] = self.covariance;
        let (vv, rr) = (variance(vv), variance(rr));
        let limit = (vv * rr).sqrt();
        let vr = if vr.is_finite() { vr.clamp(-limit, limit) } else { 0.0 };
        Self { value: within(self.value), rate: within(self.rate), covariance: [vv, vr, rr] }
    }
}

/// The filter's state at the time of its last fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kalman {
    /// When the last fix was made.
    pub fixed_at: Timestamp,
    /// Centre, x, px.
    pub x: Axis,
    /// Centre, y, px.
    pub y: Axis,
    /// Natural logarithm of the area in px².
    pub log_area: Axis,
    /// Factor on the process noise, at least 1.
    pub unrest: f64,
}

impl Kalman {
    /// A filter that has seen one fix.
    #[must_use]
    pub fn new(fix: Fix) -> Self {
        let log_area = f64::from(fix.area_px2).max(1.0).ln();
        Self {
            fixed_at: fix.captured_at,
            x: Axis::new(f64::from(fix.centroid.x), CENTRE_SIGMA_PX, FIRST_SPEED_SIGMA).bounded(),
            y: Axis::new(f64::from(fix.centroid.y), CENTRE_SIGMA_PX, FIRST_SPEED_SIGMA).bounded(),
            log_area: Axis::new(log_area, LOG_AREA_SIGMA, FIRST_RATE_SIGMA).bounded(),
            unrest: 1.0,
        }
    }

    /// The prior at `at`. Its covariance is that of the *measured* centre to be expected: state plus measurement.
    #[must_use]
    pub fn predict(&self, at: Timestamp) -> Prediction {
        let prior = self.advanced(at);
        let measured = |axis: Axis| (axis.covariance[0] + CENTRE_SIGMA_PX * CENTRE_SIGMA_PX) as f32;
        Prediction {
            centroid: PointPx::new(prior.x.value as f32, prior.y.value as f32),
            area_px2: prior.log_area.value.clamp(0.0, 20.0).exp() as f32,
            covariance_px2: [measured(prior.x), 0.0, measured(prior.y)],
        }
    }

    /// Takes a fix into account.
    pub fn update(&mut self, fix: Fix) {
        let prior = self.advanced(fix.captured_at);
        let noise = CENTRE_SIGMA_PX * CENTRE_SIGMA_PX;
        let dx = f64::from(fix.centroid.x) - prior.x.value;
        let dy = f64::from(fix.centroid.y) - prior.y.value;
        let d_area = f64::from(fix.area_px2).max(1.0).ln() - prior.log_area.value;
        // Normalised innovation squared of two axes: 2 on average when the model is right.
        let expected = |axis: Axis| axis.covariance[0] + noise;
        let normalised = 0.5 * (dx * dx / expected(prior.x) + dy * dy / expected(prior.y));
        let unrest =
            if normalised.is_finite() { self.unrest * (0.85 + 0.15 * normalised.min(30.0)) } else { 1.0 };
        *self = Self {
            fixed_at: fix.captured_at,
            x: prior.x.corrected(dx, noise),
            y: prior.y.corrected(dy, noise),
            log_area: prior.log_area.corrected(d_area, LOG_AREA_SIGMA * LOG_AREA_SIGMA),
            unrest: unrest.clamp(1.0, MAX_UNREST),
        };
    }

    fn advanced(&self, at: Timestamp) -> Self {
        let dt_s = interval_s(self.fixed_at, at);
        let density = CENTRE_ACCELERATION * self.unrest;
        Self {
            x: self.x.advanced(dt_s, density),
            y: self.y.advanced(dt_s, density),
            log_area: self.log_area.advanced(dt_s, LOG_AREA_ACCELERATION),
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn covariances_stay_finite_whatever_comes(
            fixes in proptest::collection::vec((any::<i64>(), any::<f32>(), any::<f32>(), any::<f32>()), 1..40),
            at in any::<i64>(),
        ) {
            let fix = |(nanos, x, y, area_px2): (i64, f32, f32, f32)| Fix {
                captured_at: Timestamp::from_nanos(nanos), centroid: PointPx::new(x, y), area_px2,
            };
            let mut kalman = Kalman::new(fix(fixes[0]));
            for &next in &fixes[1..] {
                kalman.update(fix(next));
            }
            let prior = kalman.predict(Timestamp::from_nanos(at));
            prop_assert!(prior.centroid.x.is_finite() && prior.centroid.y.is_finite());
            prop_assert!(prior.area_px2.is_finite() && prior.area_px2 >= 0.0);
            let [xx, xy, yy] = prior.covariance_px2;
            prop_assert!(xx.is_finite() && yy.is_finite() && xx > 0.0 && yy > 0.0 && xy * xy <= xx * yy);
        }
    }
}
