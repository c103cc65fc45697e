//! Outcomes from what was found.

use crate::landmark::Landmark;
use crate::outcome::{LandmarkOutcome, Miss, Sighting};

/// Ids that came back, to be written anew.
#[derive(Default)]
pub(crate) struct Ids(Vec<String>);

impl Ids {
    /// Takes one back.
    pub(crate) fn recycle(&mut self, id: String) {
        self.0.push(id);
    }

    fn copy_of(&mut self, id: &str) -> String {
        let mut copy = self.0.pop().unwrap_or_default();
        copy.clear();
        copy.push_str(id);
        copy
    }
}

/// As [`measured`], with an id that came back.
pub(crate) fn measured_by(
    ids: &mut Ids,
    landmark: &Landmark,
    instance: u32,
    sighting: Sighting,
) -> LandmarkOutcome {
    LandmarkOutcome { result: Ok(sighting), ..missed_by(ids, landmark, instance, Miss::Skipped) }
}

/// As [`missed`], with an id that came back.
pub(crate) fn missed_by(ids: &mut Ids, landmark: &Landmark, instance: u32, reason: Miss) -> LandmarkOutcome {
    LandmarkOutcome {
        landmark: ids.copy_of(&landmark.id),
        digest: landmark.digest,
        instance,
        prediction: None,
        gate: None,
        result: Err(reason),
        innovation_px: None,
        adaptation: None,
    }
}

/// A landmark's object that was found.
pub(crate) fn measured(landmark: &Landmark, instance: u32, sighting: Sighting) -> LandmarkOutcome {
    LandmarkOutcome { result: Ok(sighting), ..missed(landmark, instance, Miss::Skipped) }
}

/// A landmark's object that was not found.
pub(crate) fn missed(landmark: &Landmark, instance: u32, reason: Miss) -> LandmarkOutcome {
    missed_by(&mut Ids::default(), landmark, instance, reason)
}
