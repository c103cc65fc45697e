//! Steps 2 and 4–6 of thesis 4.0.3: the six statistics of a window, in exact integers.
//!
//! With n samples of value x in one channel, S = Σx and Q = Σx², the mean is S/n and the population variance is
//! (nQ − S²)/n². Whether both lie within their tolerances is decided on S and on the spread D = nQ − S² without any
//! rounding: [`Acceptance`] holds the smallest and largest integers that do.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::landmark::ColorStats;

/// Sums over one window, R, G, B.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WindowSums {
    /// Samples of the doubled grid, n.
    pub samples: u32,
    /// S = Σx, levels.
    pub sum: [u64; 3],
    /// Q = Σx², levels².
    pub sum_of_squares: [u64; 3],
}

impl WindowSums {
    /// The sums of the window at mask pixel (`x`, `y`), sample by weighted sample.
    ///
    /// # Panics
    /// When that window does not lie wholly inside the grid's region, or the region inside the frame.
    #[must_use]
    pub fn at(frame: &Frame, grid: &DoubledGrid, x: u32, y: u32) -> Self {
        let (region, window) = (grid.region(), grid.window());
        let mut sums = Self { samples: grid.samples(), ..Self::default() };
        for row in DoubledGrid::pixels_under(y, window.height) {
            let rows = DoubledGrid::samples_on(row, y, window.height);
            for column in DoubledGrid::pixels_under(x, window.width) {
                let weight = u64::from(rows * DoubledGrid::samples_on(column, x, window.width));
                for (channel, level) in frame.pixel(region.x + column, region.y + row).into_iter().enumerate()
                {
                    sums.sum[channel] += weight * u64::from(level);
                    sums.sum_of_squares[channel] += weight * u64::from(level).pow(2);
                }
            }
        }
        sums
    }

    /// D = nQ − S² of a channel: its variance times n².
    #[must_use]
    pub fn spread(&self, channel: usize) -> u64 {
        u64::from(self.samples) * self.sum_of_squares[channel] - self.sum[channel].pow(2)
    }

    /// The six statistics.
    #[must_use]
    pub fn stats(&self) -> ColorStats {
        let samples = f64::from(self.samples);
        ColorStats {
            mean: self.sum.map(|sum| (sum as f64 / samples) as f32),
            variance: [0, 1, 2].map(|channel| (self.spread(channel) as f64 / (samples * samples)) as f32),
        }
    }
}

/// The integers `low..=high`; never empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds<T> {
    /// The smallest accepted.
    pub low: T,
    /// The largest accepted.
    pub high: T,
}

impl<T: PartialOrd + Copy> Bounds<T> {
    /// Whether `value` is accepted.
    #[must_use]
    pub fn accept(&self, value: T) -> bool {
        self.low <= value && value <= self.high
    }
}

/// Which sums S and spreads D of a window of n samples lie within the tolerances, bounds inclusive (steps 7 and 8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Acceptance {
    /// For S of R, G, B.
    pub sum: [Bounds<u32>; 3],
    /// For D of R, G, B.
    pub spread: [Bounds<u64>; 3],
}

impl Acceptance {
    /// The whole levels between which accepted means lie; empty where they lie between two.
    pub(crate) fn means(&self, samples: u32) -> [Bounds<u8>; 3] {
        self.sum.map(|sum| Bounds { low: sum.low.div_ceil(samples) as u8, high: (sum.high / samples) as u8 })
    }

    /// The whole levels that enclose accepted means. A range of means holds an accepted one only where the level that its
    /// highest reaches is not below these, and the one that its lowest does not exceed is not above.
    pub(crate) fn levels_around_means(&self, samples: u32) -> [Bounds<u8>; 3] {
        self.sum.map(|sum| Bounds { low: (sum.low / samples) as u8, high: sum.high.div_ceil(samples) as u8 })
    }

    /// What `expected` ± `tolerance` accepts of windows of `samples` samples; `None` where it accepts nothing at all.
    #[must_use]
    pub fn new(expected: &ColorStats, tolerance: &ColorStats, samples: u32) -> Option<Self> {
        let (n, n2) = (u64::from(samples), u64::from(samples).pow(2));
        // Half the samples black, half white: (255/2)² n².
        let most_spread = n2 * 255 * 255 / 4;
        let mut accepted =
            Self { sum: [Bounds { low: 0, high: 0 }; 3], spread: [Bounds { low: 0, high: 0 }; 3] };
        for channel in 0..3 {
            let mean = scaled(n, expected.mean[channel], tolerance.mean[channel], 255 * n)?;
            accepted.sum[channel] = Bounds { low: mean.low as u32, high: mean.high as u32 };
            accepted.spread[channel] =
                scaled(n2, expected.variance[channel], tolerance.variance[channel], most_spread)?;
        }
        Some(accepted)
    }

    /// Whether a window with these sums matches in all six parameters.
    #[must_use]
    pub fn accepts(&self, sums: &WindowSums) -> bool {
        (0..3).all(|channel| {
            self.sum[channel].accept(sums.sum[channel] as u32)
                && self.spread[channel].accept(sums.spread(channel))
        })
    }
}

/// Bits behind the binary point of [`fixed`].
const FRACTION_BITS: u32 = 70;

/// The integers k with |k/`scale` − `expected`| ≤ `tolerance` and 0 ≤ k ≤ `most`: the lower bound is rounded up and the
/// upper one down, so that neither admits a k outside.
fn scaled(scale: u64, expected: f32, tolerance: f32, most: u64) -> Option<Bounds<u64>> {
    let (expected, tolerance) = (fixed(expected)?, fixed(tolerance)?);
    let scale = i128::from(scale);
    let low = (scale * (expected - tolerance) + (1 << FRACTION_BITS) - 1) >> FRACTION_BITS;
    let high = (scale * (expected + tolerance)) >> FRACTION_BITS;
    let bounds = Bounds { low: low.max(0) as u64, high: high.clamp(-1, i128::from(most)).try_into().ok()? };
    (bounds.low <= bounds.high).then_some(bounds)
}

/// `value` in units of 2⁻⁷⁰. Exact for every number from 2⁻⁴⁶ on; of smaller ones a remainder below 2⁻⁷⁰ is dropped.
/// What lies beyond ±65,536, where no statistic of 8-bit levels can be, stands at that limit; `None` for a NaN.
fn fixed(value: f32) -> Option<i128> {
    const LIMIT: f32 = 65_536.0;
    let scale = f64::from(FRACTION_BITS).exp2();
    (!value.is_nan()).then(|| (f64::from(value.clamp(-LIMIT, LIMIT)) * scale) as i128)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Eighths are exact in every type involved, so the definition can be checked by cross-multiplication.
        #[test]
        fn bounds_are_the_outermost_integers_inside(
            samples in 1u32..600, mean in 0u32..2100, mean_tolerance in 0u32..500,
            variance in 0u32..130_000, variance_tolerance in 0u32..2000, probe in 0.0f64..1.0,
        ) {
            let eighths = |value: u32| value as f32 / 8.0;
            let expected = ColorStats::uniform(eighths(mean), eighths(variance));
            let tolerance = ColorStats::uniform(eighths(mean_tolerance), eighths(variance_tolerance));
            let accepted = Acceptance::new(&expected, &tolerance, samples);
            let inside = |k: u64, scale: u64, middle: u32, reach: u32| {
                (8 * k).abs_diff(scale * u64::from(middle)) <= scale * u64::from(reach)
            };
            let n = u64::from(samples);
            let sum = (probe * 255.0 * n as f64) as u64;
            let spread = (probe * 16_256.0 * (n * n) as f64) as u64;
            let sum_inside = inside(sum, n, mean, mean_tolerance);
            let spread_inside = inside(spread, n * n, variance, variance_tolerance);
            match accepted {
                None => prop_assert!(!(sum_inside && spread_inside)),
                Some(accepted) => {
                    prop_assert_eq!(accepted.sum[0].accept(sum as u32), sum_inside);
                    prop_assert_eq!(accepted.spread[0].accept(spread), spread_inside);
                }
            }
        }
    }

    #[test]
    fn what_can_never_match_accepts_nothing() {
        let level = ColorStats::uniform(100.0, 10.0);
        assert_eq!(Acceptance::new(&level, &ColorStats::uniform(-1.0, 5.0), 4), None);
        assert_eq!(Acceptance::new(&level, &ColorStats::uniform(f32::NAN, 5.0), 4), None);
        assert_eq!(
            Acceptance::new(&ColorStats::uniform(300.0, 10.0), &ColorStats::uniform(5.0, 5.0), 4),
            None
        );
        assert_eq!(
            Acceptance::new(&ColorStats::uniform(100.3, 1.0), &ColorStats::uniform(0.1, 5.0), 1),
            None
        );
    }

    #[test]
    fn an_unbounded_tolerance_accepts_every_window() {
        let all =
            Acceptance::new(&ColorStats::default(), &ColorStats::uniform(f32::MAX, f32::INFINITY), 512 * 512);
        let most = 16_256 * (512_u64 * 512).pow(2);
        assert!(all.is_some_and(|all| all.sum[2].accept(255 * 512 * 512) && all.spread[2].accept(most)));
    }
}
