//! A landmark descriptor from one or several pictures of the object.
//!
//! A region is the object's bounding box. Its corners show background and its face may carry lettering, so the
//! object's own colours are told from both before the six statistics are taken (`object`); the statistics and the
//! spread that the tolerances must cover come from windows that lie wholly on the object (`windows`).

mod object;
mod windows;

use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};

/// The most shades a descriptor may hold.
pub const MAX_SHADES: usize = 16;
/// The smallest side of a region, px.
const MIN_REGION_PX: u32 = 4;

/// Tolerances of Table D.1 of the thesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Mean 15, variance 50.
    RedBlock,
    /// Mean 40, variance 70.
    BlueBlock,
    /// Mean 15, variance 40.
    StopSign,
    /// Mean 40, variance 150.
    GreenSign,
}

impl Preset {
    /// The row's tolerances: levels and levels².
    #[must_use]
    pub const fn tolerance(self) -> ColorStats {
        match self {
            Self::RedBlock => ColorStats::uniform(15.0, 50.0),
            Self::BlueBlock => ColorStats::uniform(40.0, 70.0),
            Self::StopSign => ColorStats::uniform(15.0, 40.0),
            Self::GreenSign => ColorStats::uniform(40.0, 150.0),
        }
    }
}

/// What the statistics are taken of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Template {
    /// The object in the region: background corners and lettering are told apart from it.
    #[default]
    Object,
    /// The region itself, all its pixels, as the thesis took its templates (4.0.1); the window is the region's size.
    Exact,
}

/// How tolerances are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Tolerance {
    /// From the spread of the object's own windows, never below Table D.1's red block (15, 50).
    #[default]
    Fitted,
    /// As given: levels and levels².
    Given(ColorStats),
    /// A row of Table D.1.
    Preset(Preset),
}

/// What to learn and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LearnOptions {
    /// The landmark's id.
    pub id: String,
    /// Its outline.
    pub shape: ShapeClass,
    /// Its physical width in metres, where known.
    pub size_m: Option<f32>,
    /// A window on the doubled grid instead of the fitted one.
    pub window_px: Option<WindowPx>,
    /// How tolerances are chosen.
    pub tolerance: Tolerance,
    /// What the statistics are taken of.
    pub template: Template,
}

/// Why regions do not make a landmark.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LearnError {
    /// No region at all.
    #[error("no region was given: name at least one box around the object")]
    NoRegion,
    /// A region leaves its picture.
    #[error("region {region:?} leaves its picture of {width}×{height} pixels: give a box inside it")]
    OutsideFrame {
        /// The region.
        region: RectPx,
        /// The picture's columns.
        width: u32,
        /// The picture's rows.
        height: u32,
    },
    /// A region is too small to hold statistics.
    #[error("region {region:?} is too small: both sides must be at least {MIN_REGION_PX} pixels")]
    TooSmall {
        /// The region.
        region: RectPx,
    },
    /// A number that makes no sense as a tolerance, size or window.
    #[error("{field} is {value}: it must be {allowed}")]
    OutOfRange {
        /// Which option.
        field: &'static str,
        /// What was given.
        value: f32,
        /// What is allowed.
        allowed: &'static str,
    },
}

/// The descriptor of the object that fills `regions`, each the object's bounding box in its picture.
///
/// Several regions give several shades. The digest is left zero (the wire computes it) and the revision is 1.
///
/// # Errors
/// When there is no region, one leaves its picture or is too small, or an option is out of range.
pub fn learn(regions: &[(&Frame, RectPx)], options: &LearnOptions) -> Result<Landmark, LearnError> {
    check_options(options)?;
    if regions.is_empty() {
        return Err(LearnError::NoRegion);
    }
    for (frame, region) in regions {
        check_region(frame, *region)?;
    }
    let samples: Vec<windows::Sample> = match options.template {
        Template::Object => {
            let tones = if options.shape.is_sign() { object::Tones::Apart } else { object::Tones::Together };
            regions.iter().map(|(frame, region)| object::sample(frame, *region, tones)).collect()
        }
        Template::Exact => {
            regions.iter().map(|(frame, region)| windows::Sample::exact(frame, *region)).collect()
        }
    };
    let window_px = options.window_px.unwrap_or_else(|| match options.template {
        Template::Object => windows::fitted(&samples),
        Template::Exact => exact_window(regions[0].1),
    });
    let fitted = match options.template {
        Template::Object => windows::statistics(&samples, window_px),
        Template::Exact => windows::whole(&samples),
    };
    let mut shades = fitted.shades;
    if options.shape.is_sign() && options.template == Template::Object {
        shades.truncate(MAX_SHADES - 1);
        shades.extend(object::far_view(regions, &shades));
    }
    Ok(Landmark {
        id: options.id.clone(),
        revision: 1,
        window_px,
        shades,
        tolerance: match options.tolerance {
            Tolerance::Fitted => fitted.tolerance,
            Tolerance::Given(tolerance) => tolerance,
            Tolerance::Preset(preset) => preset.tolerance(),
        },
        shape: options.shape,
        size_m: options.size_m,
        digest: Digest::default(),
    })
}

fn exact_window(region: RectPx) -> WindowPx {
    let side = |length: u32| length.min(u32::from(WindowPx::MAX_SIDE)) as u16;
    WindowPx { width: side(region.width), height: side(region.height) }
}

fn check_region(frame: &Frame, region: RectPx) -> Result<(), LearnError> {
    if region.clipped_to(frame.size()) != Some(region) {
        return Err(LearnError::OutsideFrame { region, width: frame.width(), height: frame.height() });
    }
    if region.width < MIN_REGION_PX || region.height < MIN_REGION_PX {
        return Err(LearnError::TooSmall { region });
    }
    Ok(())
}

fn check_options(options: &LearnOptions) -> Result<(), LearnError> {
    if let Some(size_m) = options.size_m
        && !(size_m.is_finite() && size_m > 0.0)
    {
        return Err(LearnError::OutOfRange { field: "size_m", value: size_m, allowed: "greater than 0 m" });
    }
    if let Some(window) = options.window_px {
        let sides = 1..=WindowPx::MAX_SIDE;
        if let Some(bad) = [window.width, window.height].into_iter().find(|side| !sides.contains(side)) {
            let allowed = "1 to 512 samples of the doubled grid";
            return Err(LearnError::OutOfRange { field: "window", value: f32::from(bad), allowed });
        }
    }
    let Tolerance::Given(given) = options.tolerance else { return Ok(()) };
    let in_range = |value: &f32| value.is_finite() && *value >= 0.0;
    match given.mean.into_iter().chain(given.variance).find(|value| !in_range(value)) {
        Some(value) => {
            Err(LearnError::OutOfRange { field: "tolerance", value, allowed: "finite and not negative" })
        }
        None => Ok(()),
    }
}
