//! What one frame said about each landmark: data, whether it was found or not.

use crate::geometry::{PointPx, Segment, SizePx};
use crate::landmark::{ColorStats, Digest, SetVersion};
use crate::timestamp::Timestamp;

/// Where one instance of a landmark was seen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sighting {
    /// Centre of the object.
    pub centroid: PointPx,
    /// The object's own area in frame pixels², compensated for the window's erosion.
    pub area_px2: f32,
    /// MATLAB `bwarea` of the chosen mask component on the doubled grid, as the thesis reports areas.
    pub mask_area_2x: f32,
    /// The closed outline, first point not repeated.
    pub outline: Vec<PointPx>,
    /// The straight pieces that the shape verdict rests on.
    pub segments: Vec<Segment>,
    /// How well the outline fits the landmark's shape class, 0..1; `None` where it is too small to tell.
    pub shape_score: Option<f32>,
    /// The six statistics as observed at the best window.
    pub observed: ColorStats,
    /// How much this deserves belief, 0..1.
    pub score: f32,
    /// How clearly it stands out from the next best candidate, 0 (a tie) to 1 (no other candidate).
    pub distinctness: f32,
}

/// One of the six statistics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Statistic {
    /// Mean of channel 0, 1 or 2 (R, G, B).
    Mean(u8),
    /// Variance of channel 0, 1 or 2 (R, G, B).
    Variance(u8),
}

/// How near the best window of a frame came to matching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestMatch {
    /// Centre of that window.
    pub at: PointPx,
    /// Its six statistics.
    pub observed: ColorStats,
    /// The statistic that was furthest outside its tolerance.
    pub worst: Statistic,
    /// By how many tolerances it was off; above 1 is a failure.
    pub excess: f32,
}

/// Why a landmark was not reported: data, not an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Miss {
    /// The prediction lies outside the picture.
    OutsideFrame,
    /// No window matched all six statistics; `best` is the nearest one where it was looked for.
    NoColour {
        /// The nearest window.
        best: Option<NearestMatch>,
    },
    /// The frame, or the object in it, is smaller than the smallest window that could match.
    TooSmall,
    /// Colour matched, the outline did not fit the landmark's shape class.
    WrongShape {
        /// The best fit, 0..1.
        score: f32,
    },
    /// Something matched, too far from the prediction to be it.
    OutsideGate {
        /// Distance of the nearest candidate from the prediction.
        innovation_px: f32,
    },
    /// Something else covers the place where it should be.
    Occluded {
        /// Part of the predicted object that is still seen, 0..1.
        visible: f32,
    },
    /// Not looked for in this frame: the bound on work per frame was reached.
    Skipped,
}

impl Miss {
    /// The name used in CSV, JSON, metrics and on pages.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::OutsideFrame => "outside_frame",
            Self::NoColour { .. } => "no_colour",
            Self::TooSmall => "too_small",
            Self::WrongShape { .. } => "wrong_shape",
            Self::OutsideGate { .. } => "outside_gate",
            Self::Occluded { .. } => "occluded",
            Self::Skipped => "skipped",
        }
    }
}

/// The prior for a frame, before its measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prediction {
    /// Where the centroid is expected.
    pub centroid: PointPx,
    /// The expected area.
    pub area_px2: f32,
    /// Covariance of the expected centroid, px²: `[xx, xy, yy]`.
    pub covariance_px2: [f32; 3],
}

/// The part of the frame where a measurement is believed: an ellipse around the prediction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gate {
    /// Centre.
    pub centre: PointPx,
    /// Half axis along x.
    pub radius_x_px: f32,
    /// Half axis along y.
    pub radius_y_px: f32,
}

/// What `adaptive` mode changed for this landmark in this frame; all neutral in `faithful` mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptation {
    /// Observed brightness over the descriptor's.
    pub gain: f32,
    /// White that haze, gloss or the camera adds to the descriptor's colours before the gain, levels; negative where it
    /// is less than when they were learned.
    pub haze: f32,
    /// Noise variance of this camera taken out of the observed variance, levels², R, G, B.
    pub noise_variance: [f32; 3],
    /// Side of the square window in use on the doubled grid.
    pub window_px: u16,
    /// Factor on the descriptor's mean tolerance.
    pub tolerance_scale: f32,
    /// Whether the whole frame was searched rather than the gate.
    pub full_frame: bool,
}

/// One landmark's (one instance's) result in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkOutcome {
    /// The landmark's id.
    pub landmark: String,
    /// The digest of the descriptor that was looked for.
    pub digest: Digest,
    /// Which of several objects that match one descriptor; counts from 0 and stays with the object.
    pub instance: u32,
    /// The prior, once there was a first sighting.
    pub prediction: Option<Prediction>,
    /// The gate that bounded the search or the belief.
    pub gate: Option<Gate>,
    /// Found, or why not.
    pub result: Result<Sighting, Miss>,
    /// Distance of the measurement from the prediction.
    pub innovation_px: Option<f32>,
    /// What was adapted; `None` in `faithful` mode.
    pub adaptation: Option<Adaptation>,
}

/// All that one frame said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The frame's number in its stream.
    pub sequence: u64,
    /// When it was captured.
    pub captured_at: Timestamp,
    /// Its size.
    pub frame_size: SizePx,
    /// Which state of the landmark set was looked for.
    pub set_version: SetVersion,
    /// One entry for each landmark and instance, in the order of the set.
    pub landmarks: Vec<LandmarkOutcome>,
}
