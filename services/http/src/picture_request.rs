//! How a viewer wants a picture: as it is asked and as it is described.

use crate::api::{Operation, integer};
use crate::parameters::Parameters;
use crate::problem::Problem;
use std::ops::RangeInclusive;

/// What a viewer asks for. Layer names are the owner's.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PictureRequest {
    /// JPEG or PNG.
    pub format: Format,
    /// What to draw over the frame, out of the owner's layers; `None` is the bare frame.
    pub layers: Option<Vec<&'static str>>,
    /// Wanted width in pixels; `None` is the frame's own.
    pub width_px: Option<u32>,
    /// Wanted JPEG quality, 1..=100; `None` is the picture's own where it is a JPEG, else the owner's choice.
    pub quality: Option<u8>,
}

/// Widths that may be asked for.
const WIDTHS_PX: RangeInclusive<u32> = 16..=3840;

/// JPEG qualities that may be asked for.
const QUALITIES: RangeInclusive<u8> = 1..=100;

impl PictureRequest {
    /// Reads `width`, `quality` and, where there are `layers` to choose from, `layers`, all of them when none is named.
    ///
    /// # Errors
    /// 400 when one of them is not allowed.
    pub fn asked(query: &mut Parameters, format: Format, layers: &[&'static str]) -> Result<Self, Problem> {
        let width_px = query.number("width", WIDTHS_PX)?;
        let quality = match format {
            Format::Jpeg => query.number("quality", QUALITIES)?,
            Format::Png => None,
        };
        let layers = if layers.is_empty() {
            None
        } else {
            Some(query.choice("layers", layers)?.unwrap_or_else(|| layers.to_vec()))
        };
        Ok(Self { format, layers, width_px, quality })
    }

    /// As [`PictureRequest::asked`], with only those `layers` that are named; the quality of what has none is not used.
    pub(crate) fn bare_unless_asked(
        query: &mut Parameters,
        format: Format,
        layers: &[&'static str],
    ) -> Result<Self, Problem> {
        let names = if layers.is_empty() { None } else { query.choice("layers", layers)? };
        let jpeg = Self::asked(query, Format::Jpeg, &[])?;
        let quality = jpeg.quality.filter(|_| format == Format::Jpeg);
        Ok(Self { format, layers: names, quality, ..jpeg })
    }

    /// Whether a JPEG as the camera sent it is what is asked for: whole, bare and of any quality.
    #[must_use]
    pub fn is_met_by_own_jpeg(&self) -> bool {
        let is_bare = self.layers.as_ref().is_none_or(Vec::is_empty);
        self.format == Format::Jpeg && is_bare && self.width_px.is_none() && self.quality.is_none()
    }

    /// Says of an operation that it takes `width` and, where there are any, `layers`.
    #[must_use]
    pub fn described(operation: Operation, layers: &'static [&'static str]) -> Operation {
        let scaled =
            operation.query("width", "Width in pixels; never above the frame's own", integer(&WIDTHS_PX));
        match layers {
            [] => scaled,
            _ => scaled.list("layers", "What to draw; everything unless said otherwise", layers),
        }
    }
}

impl Operation {
    /// Takes `quality`.
    #[must_use]
    pub fn with_quality(self) -> Self {
        self.query("quality", "JPEG quality", integer(&QUALITIES))
    }
}

/// How a picture is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// JPEG.
    Jpeg,
    /// PNG.
    Png,
}

impl Format {
    /// Its media type.
    #[must_use]
    pub const fn content_type(self) -> &'static str {
        match self {
            Self::Jpeg => "image/jpeg",
            Self::Png => "image/png",
        }
    }

    /// What a file's name ends with.
    #[must_use]
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Jpeg => "jpg",
            Self::Png => "png",
        }
    }
}
