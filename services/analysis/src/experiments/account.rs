//! What comes of an experiment.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Serialize, Serializer};
use vision::Frame;
use vision::frame::encode::{Quality, encode_jpeg, encode_png};

use super::ExperimentError;
use super::picture::enlarged;
use crate::chart::Chart;
use crate::thumbnail::smaller;

/// Pictures on the page are at most so wide; smaller ones are enlarged in whole steps towards it.
const WIDTH_PX: u32 = 480;

/// Figures, pictures and one sentence.
#[derive(Clone, Debug, Default)]
pub struct Account {
    /// What it shows, in a sentence or two.
    pub sentence: String,
    /// Each figure beside the thesis's.
    pub comparisons: Vec<Comparison>,
    /// What there is to see.
    pub pictures: Vec<Picture>,
}

/// One figure beside the thesis's.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What is compared.
    pub quantity: String,
    /// What the thesis reports.
    pub thesis: Thesis,
    /// What was found here, where it can be done again.
    pub ours: Option<f64>,
    /// Of both; empty for counts and parts.
    pub unit: &'static str,
    /// What to know about the two.
    pub note: String,
}

/// What the thesis reports of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thesis {
    /// A number.
    Number(f64),
    /// Something in words.
    Words(&'static str),
    /// Nothing.
    Silent,
}

impl Serialize for Thesis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Words(words) => serializer.serialize_str(words),
            Self::Silent => serializer.serialize_none(),
        }
    }
}

/// Something to look at.
#[derive(Clone, Debug)]
pub enum Picture {
    /// A drawing.
    Svg {
        /// The element.
        svg: String,
        /// What it shows, where the drawing does not say it.
        caption: String,
    },
    /// A picture of pixels.
    Pixels {
        /// As in `image/png`.
        media_type: &'static str,
        /// The file.
        base64: String,
        /// What it shows.
        caption: String,
    },
}

impl Account {
    /// Puts a figure beside the thesis's.
    pub(super) fn compare(
        &mut self,
        quantity: impl Into<String>,
        thesis: Thesis,
        ours: impl Into<Option<f64>>,
        unit: &'static str,
        note: impl Into<String>,
    ) {
        let (quantity, ours, note) = (quantity.into(), ours.into(), note.into());
        self.comparisons.push(Comparison { quantity, thesis, ours, unit, note });
    }

    /// Shows a chart.
    pub(super) fn chart(&mut self, chart: &Chart) -> Result<(), ExperimentError> {
        self.pictures.push(Picture::Svg { svg: chart.svg()?, caption: String::new() });
        Ok(())
    }

    /// Shows a picture from a camera.
    pub(super) fn photograph(
        &mut self,
        frame: &Frame,
        caption: impl Into<String>,
    ) -> Result<(), ExperimentError> {
        let jpeg = encode_jpeg(&smaller(frame, WIDTH_PX), Quality::default())?;
        self.pixels("image/jpeg", &jpeg, caption.into());
        Ok(())
    }

    /// Shows a computed picture, every pixel of which counts.
    pub(super) fn picture(
        &mut self,
        frame: &Frame,
        caption: impl Into<String>,
    ) -> Result<(), ExperimentError> {
        let factor = (WIDTH_PX / frame.width().max(1)).max(1);
        self.pixels("image/png", &encode_png(&enlarged(&smaller(frame, WIDTH_PX), factor)?)?, caption.into());
        Ok(())
    }

    fn pixels(&mut self, media_type: &'static str, bytes: &[u8], caption: String) {
        self.pictures.push(Picture::Pixels { media_type, base64: STANDARD.encode(bytes), caption });
    }
}
