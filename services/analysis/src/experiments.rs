//! Every experiment of the reference thesis's chapters 2 to 4, done again: on its synthetic scenes, on the tables that it
//! prints, and on simulated drives in place of its videos, which were not published. Each result stands beside what the
//! thesis reports; what cannot be done again says so.
//!
//! An experiment is one function in a file of its own and one line in [`ALL`]. Nothing here knows an expected result:
//! what is "ours" is computed each time, and so is what is said about it.

mod account;
mod appendix;
mod chapter2;
mod chapter3;
mod chapter4;
mod conclusions;
mod document;
mod drive;
mod edges;
mod lab;
mod leftmost;
mod noise;
mod picture;
mod registry;
mod sampled;
mod scene;
mod selection;

use vision::LearnError;

pub use account::{Account, Comparison, Picture, Thesis};
pub use conclusions::{Conclusion, Verdict, conclusions};
pub use document::html;
pub use lab::Lab;
pub use registry::ALL;
pub use selection::{UnknownSelection, selected};

use crate::chart::ChartError;

/// What kind of place in the thesis an experiment does again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A figure.
    Figure,
    /// A table.
    Table,
    /// A section's text.
    Section,
}

impl Place {
    /// The word before the number.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Figure => "Fig",
            Self::Table => "Table",
            Self::Section => "Section",
        }
    }
}

/// One experiment.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// What is done again.
    pub place: Place,
    /// Its number, as in `4.1` or `D.1`; results are named after it.
    pub number: &'static str,
    /// The section that describes it.
    pub section: &'static str,
    /// In a few words.
    pub title: &'static str,
    /// Does it.
    pub run: fn(&Lab) -> Result<Account, ExperimentError>,
}

/// An experiment that could not be done.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The scene cannot be simulated.
    #[error(transparent)]
    Scene(#[from] simulator::OptionsError),
    /// Nothing can be learned from the view.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// What the leader shows cannot be learned.
    #[error(transparent)]
    Lesson(#[from] crate::lesson::LessonError),
    /// A chart.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// A picture cannot be encoded.
    #[error(transparent)]
    Encode(#[from] vision::frame::encode::EncodeError),
    /// A picture cannot be decoded again.
    #[error(transparent)]
    Decode(#[from] vision::frame::decode::DecodeError),
    /// Pictures of two sizes.
    #[error(transparent)]
    SizesDiffer(#[from] vision::methods::SizesDiffer),
    /// A picture without pixels.
    #[error(transparent)]
    NoPixels(#[from] vision::methods::fourier::NoPixels),
    /// A template that correlates with nothing.
    #[error(transparent)]
    Ncc(#[from] vision::methods::ncc::NccError),
    /// Control points that give no map.
    #[error(transparent)]
    ControlPoints(#[from] vision::methods::control_points::ControlPointsError),
    /// A picture of an impossible size.
    #[error(transparent)]
    Size(#[from] vision::frame::SizeMismatch),
    /// The scene does not show what the experiment needs.
    #[error("frame {frame} of {scene} does not show `{object}` as the experiment needs it")]
    NotShown {
        /// The scene's name.
        scene: String,
        /// Counts from 1.
        frame: usize,
        /// The object.
        object: String,
    },
    /// A table of the thesis that does not read as one.
    #[error("the table of {name} cannot be read: {source}")]
    Appendix {
        /// Which.
        name: &'static str,
        /// Why.
        source: csv::Error,
    },
}

/// An experiment and what came of it.
#[derive(Debug)]
pub struct Done {
    /// The experiment.
    pub experiment: Experiment,
    /// What came of it.
    pub account: Account,
    /// Processor time of this thread that it took.
    pub cpu_s: f64,
}

/// Does `experiments` one after the other; `on_done` hears of each.
///
/// # Errors
/// The first that cannot be done.
pub fn run(
    experiments: &[Experiment],
    lab: &Lab,
    mut on_done: impl FnMut(&Done),
) -> Result<Vec<Done>, ExperimentError> {
    let mut all = Vec::with_capacity(experiments.len());
    for experiment in experiments {
        let started_ns = crate::stage_times::thread_cpu_ns();
        let account = (experiment.run)(lab)?;
        let cpu_s = crate::stage_times::thread_cpu_ns().saturating_sub(started_ns) as f64 * 1e-9;
        let done = Done { experiment: *experiment, account, cpu_s };
        on_done(&done);
        all.push(done);
    }
    Ok(all)
}

/// One entry of `results.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ResultRow {
    /// The place's number and the quantity, as in `4.4 blue x`.
    pub id: String,
    /// What the thesis reports; null where it says nothing.
    pub thesis: Thesis,
    /// What was found here; null where it cannot be done again, and `note` says why.
    pub ours: Option<f64>,
    /// Of both.
    pub unit: &'static str,
    /// What to know about the two.
    pub note: String,
}

/// The content of `results.json`.
#[must_use]
pub fn results(done: &[Done]) -> Vec<ResultRow> {
    let rows = done.iter().flat_map(|done| {
        done.account.comparisons.iter().map(|comparison| ResultRow {
            id: format!("{} {}", done.experiment.number, comparison.quantity),
            thesis: comparison.thesis,
            ours: comparison.ours.filter(|value| value.is_finite()),
            unit: comparison.unit,
            note: comparison.note.clone(),
        })
    });
    rows.collect()
}
