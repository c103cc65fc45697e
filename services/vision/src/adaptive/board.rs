//! Upright rectangular signs: the boxes that mixtures of the sign's colour and its lettering's fill.
//!
//! Signs beside the road overlap each other and stand before bushes of nearly their tint: what is connected by its tint
//! is several things. But hardly a pixel of anything else is a mixture of the sign's two colours under the light of the
//! moment, and what such pixels fill is a box. So the box of the greatest sum is looked for ([`field`]), where pixels that
//! belong to the sign count for it and others against it; its sides go where its outline is plainest ([`outline`]); and
//! what is left beside it may hold another ([`search`]). A bush can have any one colour of the mixtures. That some of its
//! pixels are lettering and others are not tells a sign, from about thirty pixels on.

mod field;
mod outline;
mod search;
mod shares;
#[cfg(test)]
mod tests;

pub(super) use search::find;

use super::candidate::Search;
use super::mixture::TwoColours;
use field::Area;

/// A pixel counts for a box when it belongs to the sign by more than this.
const BELONGS: f32 = 0.62;
/// The smallest box: width and height, px.
const LEAST_PX: (i32, i32) = (4, 3);

/// An object of this area is as likely a speck as a sign, px².
const SPECK_AREA_PX2: f32 = 10.0;
/// A box that is filled so much has no gaps.
const FULL: f32 = 0.78;
/// Lettering is a smear on a sign of this area and can be read on one of that, px².
const READABLE_PX2: (f32, f32) = (40.0, 250.0);
/// How unevenly lettering is spread over either, as a part of what the descriptor tells.
const SPREAD: (f32, f32) = (0.49, 0.62);
/// Less than this part of that is a surface of one colour, more than that part is surely lettered.
const LETTERED: (f32, f32) = (0.72, 0.88);
/// How much more of either may be light than the descriptor tells: of a small sign the border is a good part.
const PALER: (f32, f32) = (0.26, 0.12);
/// How fast it becomes unlikely beyond.
const TOO_PALE: f32 = 0.06;
/// The light on it is the expected one within this factor's logarithm.
const LIGHT_SIGMA: f32 = 0.4;
/// Brings the product to the scale of other landmarks: the exponent.
const SCALE: f32 = 0.65;

/// One box and what speaks for it.
#[derive(Clone, Copy, Debug)]
struct Board {
    /// In pixels of the rectangle in which it was found.
    area: Area,
    /// How much its pixels belong to the sign, on average.
    fill: f32,
    /// How much those around it do.
    around: f32,
    /// Mean of the part that is lettering, and its standard deviation.
    pale: f32,
    spread: f32,
}

impl Board {
    /// How much it looks like the sign, 0..1.
    fn score(&self, search: &Search<'_>, colours: &TwoColours, area_px2: f32, gain: f32) -> f32 {
        let size = area_px2 / (area_px2 + SPECK_AREA_PX2);
        let light = (-0.5 * ((gain / search.light.gain).max(1e-3).ln() / LIGHT_SIGMA).powi(2)).exp();
        let fill = (self.fill / FULL).min(1.0).powi(2);
        let face = self.tone(colours) * self.lettered(colours);
        (size * light * fill * (1.0 - self.around) * face).powf(SCALE)
    }

    /// How well the part that is lettering suits the sign's.
    fn tone(&self, colours: &TwoColours) -> f32 {
        let off = (self.pale - colours.part() - self.as_readable(PALER)).max(0.0);
        (-0.5 * (off / TOO_PALE).powi(2)).exp()
    }

    /// How surely some of it is lettering and some is not, 0..1.
    fn lettered(&self, colours: &TwoColours) -> f32 {
        let seen = self.spread / (self.as_readable(SPREAD) * colours.spread());
        ((seen - LETTERED.0) / (LETTERED.1 - LETTERED.0)).clamp(0.0, 1.0)
    }

    /// Between what holds of a smear and of what can be read, by its size.
    fn as_readable(&self, (smear, read): (f32, f32)) -> f32 {
        let (least, most) = READABLE_PX2;
        let readable = ((self.area.pixels() / least).ln() / (most / least).ln()).clamp(0.0, 1.0);
        smear + readable * (read - smear)
    }
}
