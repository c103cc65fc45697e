//! The names that `register`'s options take, with what each means.

use analysis::table::RowFormat;
use clap::ValueEnum;
use vision::follow::Mode;
use vision::predict::PredictionMethod;

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ModeName {
    /// The published method: fixed statistics and tolerances, every frame searched whole
    Faithful,
    /// Follows light, noise and scale, and searches where the object is expected first
    Adaptive,
}

impl From<ModeName> for Mode {
    fn from(name: ModeName) -> Self {
        match name {
            ModeName::Faithful => Self::Faithful,
            ModeName::Adaptive => Self::Adaptive,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum PredictionName {
    /// Where it was last
    Persistence,
    /// Straight on at the speed of the last two sightings
    ConstantVelocity,
    /// A Kalman filter on position, velocity, log area and its rate
    Kalman,
}

impl From<PredictionName> for PredictionMethod {
    fn from(name: PredictionName) -> Self {
        match name {
            PredictionName::Persistence => Self::Persistence,
            PredictionName::ConstantVelocity => Self::ConstantVelocity,
            PredictionName::Kalman => Self::Kalman,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum FormatName {
    /// Comma-separated values with a header line
    Csv,
    /// One JSON object a line, null where unknown
    Ndjson,
}

impl From<FormatName> for RowFormat {
    fn from(name: FormatName) -> Self {
        match name {
            FormatName::Csv => Self::Csv,
            FormatName::Ndjson => Self::Ndjson,
        }
    }
}
