//! Which method registers a landmark best: the thesis's methods side by side on the frames of one's own input.
//!
//! Each method sees the same frames one after the other and claims at most one place a frame. With truth it is judged by
//! truth; without, by whether others claim the same place and whether its own claims stay together. A method that needs a
//! picture of the object takes it where the adaptive registration first sees it.

mod blob;
mod carried;
mod contender;
mod correlation;
mod document;
mod figures;
mod findings;
mod lone_hough;
mod method;
mod race;
mod shots;
mod statistical;

use std::path::PathBuf;

use serde::Serialize;
use vision::{Landmark, RectPx, SizePx};

pub use document::html;
pub use figures::MethodFigures;
pub use findings::findings;
pub use method::{Method, UnknownMethod};
pub use race::{compare, expected_frames};

use crate::chart::ChartError;
use crate::input::{Input, InputError};
use crate::truth::TruthError;

/// What is compared.
#[derive(Clone, Debug)]
pub struct Question {
    /// The frames.
    pub inputs: Vec<Input>,
    /// What is looked for; none for what a recording itself says.
    pub landmarks: Vec<Landmark>,
    /// Where the objects really were, for all inputs that do not say it themselves.
    pub truth: Option<PathBuf>,
    /// Who takes part.
    pub methods: Vec<Method>,
}

/// Why nothing can be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// An input.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The truth.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// A recording.
    #[error(transparent)]
    Recording(#[from] recording::RecordingError),
    /// A chart of the report.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// Nothing says what to look for.
    #[error("`{given}` brings no landmarks of its own; say what to look for with --landmark FILE")]
    NoLandmark {
        /// The input.
        given: String,
    },
    /// No picture at all.
    #[error("`{given}` holds no picture that can be decoded")]
    NoFrame {
        /// The input.
        given: String,
    },
}

/// By what methods are judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judge {
    /// Where the object really was.
    Truth,
    /// What the others claim, and whether claims stay together.
    Agreement,
}

/// One landmark over one camera's frames.
#[derive(Debug, Serialize)]
pub struct Race {
    /// The input as given.
    pub input: String,
    /// The camera, where there are several.
    pub camera: Option<String>,
    /// The landmark.
    pub landmark: String,
    /// Frames that were decoded.
    pub frames: u64,
    /// Frames that could not be.
    pub lost: u64,
    /// The frame in which methods that need a picture of the object got it.
    pub template_frame: Option<u64>,
    /// By what methods are judged.
    pub judge: Judge,
    /// Each method.
    pub methods: Vec<MethodFigures>,
    /// What the report shows beside the figures.
    #[serde(skip)]
    pub(crate) course: race::Course,
}

/// The box around an object of that centre and extent, as far as it lies in the picture.
fn box_around(centre: vision::PointPx, width: f32, height: f32, size: SizePx) -> Option<RectPx> {
    let start = |centre: f32, length: f32| (centre - length / 2.0).round().max(0.0) as u32;
    let rect = RectPx {
        x: start(centre.x, width),
        y: start(centre.y, height),
        width: (width.round() as u32).max(1),
        height: (height.round() as u32).max(1),
    };
    rect.clipped_to(size)
}
