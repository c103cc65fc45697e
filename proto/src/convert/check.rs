//! The checks that every conversion from the wire is made of.

use std::fmt;
use std::ops::RangeInclusive;

use vision::{Digest, PointPx};

use crate::keys::{Id, InvalidId};
use crate::v1;

/// A value of a wire message that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} is {value}; allowed: {allowed}")]
pub struct InvalidField {
    /// Path of the field within its message, as in `shades[2].variance[0]`.
    pub field: String,
    /// What it holds.
    pub value: String,
    /// What it may hold.
    pub allowed: String,
}

impl InvalidField {
    pub(super) fn new(
        field: impl fmt::Display,
        value: impl fmt::Display,
        allowed: impl fmt::Display,
    ) -> Self {
        Self { field: field.to_string(), value: value.to_string(), allowed: allowed.to_string() }
    }

    /// The same fault, seen from the message that holds this one.
    #[must_use]
    pub(super) fn inside(mut self, outer: impl fmt::Display) -> Self {
        self.field = format!("{outer}.{}", self.field);
        self
    }
}

impl From<InvalidId> for InvalidField {
    fn from(invalid: InvalidId) -> Self {
        Self::new(invalid.field, format_args!("{:?}", invalid.value), Id::ALLOWED)
    }
}

pub(super) fn finite(field: impl fmt::Display, value: f32) -> Result<f32, InvalidField> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(InvalidField::new(field, value, "a finite number"))
}

pub(super) fn finite_f64(field: impl fmt::Display, value: f64) -> Result<f64, InvalidField> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(InvalidField::new(field, value, "a finite number"))
}

pub(super) fn not_negative(field: impl fmt::Display, value: f32) -> Result<f32, InvalidField> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    Err(InvalidField::new(field, format_args!("{value:?}"), "a finite number, 0 or greater"))
}

pub(super) fn within(
    field: impl fmt::Display,
    value: f32,
    limits: RangeInclusive<f32>,
) -> Result<f32, InvalidField> {
    if limits.contains(&value) {
        return Ok(value);
    }
    let (least, most) = limits.into_inner();
    Err(InvalidField::new(field, format_args!("{value:?}"), format_args!("{least} to {most}")))
}

pub(super) fn fraction(field: impl fmt::Display, value: f32) -> Result<f32, InvalidField> {
    within(field, value, 0.0..=1.0)
}

pub(super) fn count_within(
    field: impl fmt::Display,
    value: u64,
    limits: RangeInclusive<u64>,
) -> Result<u64, InvalidField> {
    if limits.contains(&value) {
        return Ok(value);
    }
    let (least, most) = limits.into_inner();
    let allowed = if most == u64::MAX { format!("at least {least}") } else { format!("{least} to {most}") };
    Err(InvalidField::new(field, value, allowed))
}

pub(super) fn present<T>(field: impl fmt::Display, value: Option<T>) -> Result<T, InvalidField> {
    value.ok_or_else(|| InvalidField::new(field, "absent", "present"))
}

pub(super) fn digest(field: impl fmt::Display, bytes: &[u8]) -> Result<Digest, InvalidField> {
    let exact = <[u8; 32]>::try_from(bytes).map_err(|_| {
        InvalidField::new(field, format_args!("{} bytes long", bytes.len()), "32 bytes of SHA-256")
    })?;
    Ok(Digest(exact))
}

pub(super) fn point(field: impl fmt::Display, point: Option<&v1::Point>) -> Result<PointPx, InvalidField> {
    let point = present(&field, point)?;
    let x = finite(format_args!("{field}.x_px"), point.x_px)?;
    let y = finite(format_args!("{field}.y_px"), point.y_px)?;
    Ok(PointPx { x, y })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_field_value_and_limit() {
        let error = within("shades[0].mean[1]", f32::NAN, 0.0..=255.0).unwrap_err().inside("landmark");
        assert_eq!(error.to_string(), "landmark.shades[0].mean[1] is NaN; allowed: 0 to 255");
        let error = not_negative("area_px2", -1e30).unwrap_err();
        assert_eq!(error.to_string(), "area_px2 is -1e30; allowed: a finite number, 0 or greater");
        let error = count_within("revision", 0, 1..=u64::MAX).unwrap_err();
        assert_eq!(error.to_string(), "revision is 0; allowed: at least 1");
    }

    #[test]
    fn nothing_but_finite_numbers_within_bounds_passes() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(finite("x", value).is_err());
            assert!(not_negative("x", value).is_err());
            assert!(within("x", value, 0.0..=1.0).is_err());
        }
        assert!(not_negative("x", -0.5).is_err());
        assert!(fraction("x", 1.5).is_err());
        assert_eq!(fraction("x", 1.0), Ok(1.0));
    }
}
