//! How to follow, where a recording may say how it was done live.

use vision::follow::{FollowOptions, Mode};
use vision::predict::PredictionMethod;
use vision::register::ShapeVeto;

/// What was asked for; the rest is as a recording says, or else as usual.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FollowChoice {
    /// How a landmark is registered.
    pub mode: Option<Mode>,
    /// How the next place is told from the earlier ones.
    pub prediction: Option<PredictionMethod>,
    /// What a misfit of the shape means.
    pub shape_veto: Option<ShapeVeto>,
}

impl FollowChoice {
    /// The choice, with what `recorded` says where nothing was chosen.
    #[must_use]
    pub fn over(self, recorded: Option<FollowOptions>) -> FollowOptions {
        let usual = recorded.unwrap_or_default();
        FollowOptions {
            mode: self.mode.unwrap_or(usual.mode),
            prediction: self.prediction.unwrap_or(usual.prediction),
            shape_veto: self.shape_veto.unwrap_or(usual.shape_veto),
            ..usual
        }
    }
}
