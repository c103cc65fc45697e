//! Normalised cross correlation (thesis 2.7.4, eq. 2.22): how alike a template and each window of a frame are, whatever
//! their brightness and contrast.
//!
//! The sum over products comes from Fourier transforms (eq. 2.8), the windows' means and variances from running sums in
//! whole numbers. In colour all three channels' sums are added before the division, as OpenCV's `TM_CCOEFF_NORMED` does.

mod levels;
mod template;
mod windows;

use crate::frame::Frame;
use crate::geometry::{PointPx, RectPx, SizePx};

use super::fourier::{Fourier, Spectrum, fast_length};
use super::plane::Plane;
use levels::Levels;
use template::Template;
use windows::WindowSums;

/// What of the pictures is compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// Their luma.
    #[default]
    Grey,
    /// All three channels.
    Rgb,
}

impl Colours {
    fn channels(self) -> usize {
        match self {
            Self::Grey => 1,
            Self::Rgb => 3,
        }
    }
}

/// How a template is searched.
#[derive(Clone, Debug, PartialEq)]
pub struct NccOptions {
    /// What is compared.
    pub colours: Colours,
    /// The sizes at which it is looked for, as factors on the template's own.
    pub scales: Vec<f32>,
}

impl Default for NccOptions {
    /// Grey, at its own size.
    fn default() -> Self {
        Self { colours: Colours::Grey, scales: vec![1.0] }
    }
}

/// The best window of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// The window's centre.
    pub at: PointPx,
    /// The window.
    pub window: RectPx,
    /// The factor on the template's size.
    pub scale: f32,
    /// γ of eq. 2.22, −1..1; 1 where the window is the template, brighter or darker, with more or less contrast.
    pub score: f32,
}

/// Why a template cannot be searched for.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NccError {
    /// It has no pixel, at its own size or at a smaller scale.
    #[error("at scale {scale} the template has no pixel left; give a larger template or scale")]
    Empty {
        /// The scale.
        scale: f32,
    },
    /// At a scale it is larger than any picture.
    #[error(
        "at scale {scale} the template is {side} pixels long; at most {LARGEST_SIDE} are allowed: give a smaller scale"
    )]
    TooLarge {
        /// The scale.
        scale: f32,
        /// The longer side in pixels.
        side: u32,
    },
    /// All its pixels are equal, so every window is as alike as any other.
    #[error("at scale {scale} all pixels of the template are equal; choose one with some structure")]
    Flat {
        /// The scale.
        scale: f32,
    },
    /// A scale is not a positive number, or there is none.
    #[error(
        "scale {scale} of the template; scales must be finite, above 0 and at most {most}, and there must be one"
    )]
    Scale {
        /// The scale; NaN where none was given.
        scale: f32,
        /// The largest that is allowed.
        most: f32,
    },
}

/// Scales above this are refused: they are a mistake, and cost memory.
const LARGEST_SCALE: f32 = 64.0;
/// Sums down the columns of windows that are higher would not fit.
const LARGEST_SIDE: u32 = 65_535;

/// A template at its scales, with the memory to search frame after frame.
#[derive(Clone, Debug)]
pub struct Ncc {
    colours: Colours,
    templates: Vec<Template>,
    fourier: Option<Fourier>,
    levels: Levels,
    frame: Vec<Spectrum>,
    product: Spectrum,
    sums: WindowSums,
    surface: Plane,
}

impl Ncc {
    /// Prepares to search for `template`.
    ///
    /// # Errors
    /// When it is empty or flat at one of the scales, or a scale is none.
    pub fn new(template: &Frame, options: &NccOptions) -> Result<Self, NccError> {
        let most = LARGEST_SCALE;
        if options.scales.is_empty() {
            return Err(NccError::Scale { scale: f32::NAN, most });
        }
        let at_scale = |&scale: &f32| {
            if !(scale > 0.0 && scale <= most) {
                return Err(NccError::Scale { scale, most });
            }
            Template::new(template, options.colours, scale)
        };
        Ok(Self {
            colours: options.colours,
            templates: options.scales.iter().map(at_scale).collect::<Result<_, _>>()?,
            fourier: None,
            levels: Levels::default(),
            frame: Vec::new(),
            product: Spectrum::default(),
            sums: WindowSums::default(),
            surface: Plane::default(),
        })
    }

    /// The best of all windows at all scales that lie wholly inside `region`, the whole frame where there is none; `None`
    /// when none fits.
    pub fn search(&mut self, frame: &Frame, region: Option<RectPx>) -> Option<Match> {
        let region = region.unwrap_or(RectPx::whole(frame.size())).clipped_to(frame.size())?;
        self.transform(frame, region);
        let mut best: Option<Match> = None;
        for number in 0..self.templates.len() {
            self.correlate(number);
            let Some((x, y, score)) = self.surface.maximum() else { continue };
            if best.is_none_or(|best| score > best.score) {
                let Template { size, scale, .. } = self.templates[number];
                let (x, y) = (region.x + x, region.y + y);
                let at =
                    PointPx::new(x as f32 + size.width as f32 / 2.0, y as f32 + size.height as f32 / 2.0);
                let window = RectPx { x, y, width: size.width, height: size.height };
                best = Some(Match { at, window, scale, score });
            }
        }
        best
    }

    /// γ of every window inside `region` at the first scale: the value at (x, y) belongs to the window whose first pixel is
    /// (region.x + x, region.y + y). Flat windows have 0. Empty where no window fits.
    pub fn surface(&mut self, frame: &Frame, region: Option<RectPx>) -> &Plane {
        self.surface.reset(SizePx::default());
        let region = region.unwrap_or(RectPx::whole(frame.size())).clipped_to(frame.size());
        if let Some(region) = region {
            self.transform(frame, region);
            self.correlate(0);
        }
        &self.surface
    }

    /// The spectra of the region's channels.
    fn transform(&mut self, frame: &Frame, region: RectPx) {
        let suits = |has: u32, needed: u32| needed <= has && has <= 2 * fast_length(needed);
        // A gate that is cut off at the frame's edge needs no plan of its own.
        let planned = self.fourier.as_ref().map(Fourier::size);
        if !planned.is_some_and(|has| suits(has.width, region.width) && suits(has.height, region.height)) {
            let size = SizePx { width: fast_length(region.width), height: fast_length(region.height) };
            self.fourier = Fourier::new(size).ok();
            self.templates.iter_mut().for_each(|template| template.spectra.clear());
        }
        let Some(fourier) = &mut self.fourier else { return };
        self.levels.read(frame, region, self.colours);
        self.frame.resize_with(self.colours.channels(), Spectrum::default);
        for (channel, spectrum) in self.frame.iter_mut().enumerate() {
            let fill = |y: usize, row: &mut [f32]| self.levels.centred(channel, y as u32, row);
            fourier.forward_rows(region.height as usize, region.width as usize, fill, spectrum);
        }
    }

    /// Makes `surface` that of one template.
    fn correlate(&mut self, number: usize) {
        let region = self.levels.size();
        let template = &mut self.templates[number];
        let SizePx { width, height } = template.size;
        let places = SizePx {
            width: (region.width + 1).saturating_sub(width),
            height: (region.height + 1).saturating_sub(height),
        };
        if places.width == 0 || places.height == 0 {
            self.surface.reset(SizePx::default());
            return;
        }
        let Some(fourier) = &mut self.fourier else { return };
        self.surface.reset(places);
        template.transform(fourier);
        template.correlate(&self.frame, &mut self.product);
        self.sums.begin(&self.levels, template.size);
        let (norm, columns) = (template.norm as f32, places.width as usize);
        fourier.inverse_rows(&mut self.product, places.height as usize, |y, row| {
            let scores = self.surface.row_mut(y as u32);
            scores.copy_from_slice(&row[..columns]);
            self.sums.divide(&self.levels, y as u32, norm, scores);
        });
    }
}

#[cfg(test)]
mod tests;
