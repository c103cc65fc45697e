//! The six statistics.

use std::fmt;

use vision::ColorStats;

use super::check::{InvalidField, not_negative, present, within};
use crate::v1;

/// The greatest mean of 8-bit levels.
const MAX_MEAN: f32 = 255.0;
/// The greatest population variance of 8-bit levels: half of them 0, half 255.
const MAX_VARIANCE: f32 = MAX_MEAN * MAX_MEAN / 4.0;

pub(super) fn stats_to_wire(stats: &ColorStats) -> v1::ColorStats {
    v1::ColorStats { mean: stats.mean.to_vec(), variance: stats.variance.to_vec() }
}

/// Statistics of a descriptor, or its tolerances: within what 8-bit levels can give.
pub(super) fn bounded_stats(
    field: impl fmt::Display,
    stats: Option<&v1::ColorStats>,
) -> Result<ColorStats, InvalidField> {
    let stats = present(&field, stats)?;
    Ok(ColorStats {
        mean: channels(format_args!("{field}.mean"), &stats.mean, |field, value| {
            within(field, value, 0.0..=MAX_MEAN)
        })?,
        variance: channels(format_args!("{field}.variance"), &stats.variance, |field, value| {
            within(field, value, 0.0..=MAX_VARIANCE)
        })?,
    })
}

/// Statistics as observed: rounding may carry them past the exact limits.
pub(super) fn observed_stats(
    field: impl fmt::Display,
    stats: Option<&v1::ColorStats>,
) -> Result<ColorStats, InvalidField> {
    let stats = present(&field, stats)?;
    Ok(ColorStats {
        mean: channels(format_args!("{field}.mean"), &stats.mean, not_negative)?,
        variance: channels(format_args!("{field}.variance"), &stats.variance, not_negative)?,
    })
}

pub(super) fn channels(
    field: impl fmt::Display,
    values: &[f32],
    check: impl Fn(String, f32) -> Result<f32, InvalidField>,
) -> Result<[f32; 3], InvalidField> {
    let &[red, green, blue] = values else {
        let value = format_args!("{} values", values.len());
        return Err(InvalidField::new(field, value, "three values: R, G, B"));
    };
    Ok([
        check(format!("{field}[0]"), red)?,
        check(format!("{field}[1]"), green)?,
        check(format!("{field}[2]"), blue)?,
    ])
}
