//! What a comparison came to.

use std::collections::BTreeMap;

use crate::diff::Change;
use crate::input::Past;

/// Counts over all frames that were compared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiffTally {
    /// Frames whose result was compared with a recorded one that can be had again.
    pub compared: u64,
    /// Those of them that differ.
    pub different: u64,
    /// Frames whose recorded result rests on pictures that are not in the file: compared, but not judged.
    pub without_past: u64,
    /// Those of them that differ.
    pub different_without_past: u64,
    /// Frames that have a result now and had none, or none that is in the file.
    pub without_result: u64,
    /// What differs where it should not, by field.
    pub fields: BTreeMap<&'static str, FieldTally>,
}

/// How often and by how much one field differs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldTally {
    /// Times.
    pub changes: u64,
    /// The largest amount, without sign; `None` where amounts are no numbers.
    pub largest: Option<f64>,
}

impl DiffTally {
    /// Counts a frame.
    pub fn count(&mut self, past: Past, changes: &[Change]) {
        let differs = u64::from(!changes.is_empty());
        match past {
            Past::Whole => {
                self.compared += 1;
                self.different += differs;
                changes.iter().for_each(|change| self.fields.entry(change.field).or_default().count(change));
            }
            Past::Missing => {
                self.without_past += 1;
                self.different_without_past += differs;
            }
        }
    }
}

impl FieldTally {
    fn count(&mut self, change: &Change) {
        self.changes += 1;
        let amount = change.difference.map(f64::abs);
        self.largest = self.largest.into_iter().chain(amount).max_by(f64::total_cmp);
    }
}
