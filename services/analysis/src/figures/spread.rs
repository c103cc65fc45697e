//! How a quantity is spread.

use serde::{Deserialize, Serialize};

/// Mean, population variance and standard deviation, as the thesis's Tables 4.4 and 4.5 have them, and the largest
/// amount.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// How many values.
    pub count: u64,
    /// Their mean.
    pub mean: f64,
    /// Their variance around it.
    pub variance: f64,
    /// Its square root.
    pub standard_deviation: f64,
    /// The largest value without its sign.
    pub largest: f64,
}

impl Spread {
    /// The spread of `values`; `None` when there are none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        if values.is_empty() {
            return None;
        }
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        Some(Self {
            count: values.len() as u64,
            mean,
            variance,
            standard_deviation: variance.sqrt(),
            largest: values.iter().fold(0.0, |largest, value| value.abs().max(largest)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_the_populations() {
        let spread = Spread::of(&[2.0, -4.0, 2.0]).unwrap();
        assert_eq!((spread.count, spread.mean, spread.variance, spread.largest), (3, 0.0, 8.0, 4.0));
        assert_eq!(Spread::of(&[]), None);
    }
}
