//! Outcomes from what was found.

use crate::landmark::Landmark;
use crate::outcome::{LandmarkOutcome, Miss, Sighting};

/// A landmark's object that was found.
pub(crate) fn measured(landmark: &Landmark, instance: u32, sighting: Sighting) -> LandmarkOutcome {
    LandmarkOutcome { result: Ok(sighting), ..missed(landmark, instance, Miss::Skipped) }
}

/// A landmark's object that was not found.
pub(crate) fn missed(landmark: &Landmark, instance: u32, reason: Miss) -> LandmarkOutcome {
    LandmarkOutcome {
        landmark: landmark.id.clone(),
        digest: landmark.digest,
        instance,
        prediction: None,
        gate: None,
        result: Err(reason),
        innovation_px: None,
        adaptation: None,
    }
}
