//! Outcomes from what was found.

use crate::landmark::Landmark;
use crate::outcome::{LandmarkOutcome, Miss, Sighting};
use crate::register::Workspace;

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

/// Where what was found of a landmark goes, and memory for it that came back.
pub(super) struct Report<'a> {
    pub(super) outcomes: &'a mut Vec<LandmarkOutcome>,
    pub(super) ids: &'a mut Ids,
    pub(super) workspace: &'a mut Workspace,
}

impl Report<'_> {
    /// A landmark's object that was found.
    pub(super) fn measured(
        &mut self,
        landmark: &Landmark,
        instance: u32,
        sighting: Sighting,
    ) -> LandmarkOutcome {
        LandmarkOutcome { result: Ok(sighting), ..self.missed(landmark, instance, Miss::Skipped) }
    }

    /// A landmark's object that was not found.
    pub(super) fn missed(&mut self, landmark: &Landmark, instance: u32, reason: Miss) -> LandmarkOutcome {
        missed_by(self.ids, landmark, instance, reason)
    }
}

/// A landmark's object that was not found, with an id that came back.
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

/// A landmark's object that was not found.
pub(crate) fn missed(landmark: &Landmark, instance: u32, reason: Miss) -> LandmarkOutcome {
    missed_by(&mut Ids::default(), landmark, instance, reason)
}
