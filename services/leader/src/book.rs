//! The landmark set of a leader: a state machine over edits, without clock, disk or network.
//!
//! Every change of a landmark's content raises its revision, every change of the set its version, and every start of
//! the leader the epoch, so that followers can tell new from old whatever order they hear it in.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use vision::{Landmark, LandmarkSet, SetVersion};

/// The most landmarks that a set may hold: a message that holds them all stays within its limit.
pub const MAX_LANDMARKS: usize = 20_000;

/// What is to change; made as a whole or not at all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edit {
    /// Added, or put in the place of those with the same id; revisions are given here, not taken over.
    pub publish: Vec<Landmark>,
    /// Ids that leave the set.
    pub retire: Vec<String>,
    /// What happens to landmarks that the edit does not name.
    pub others: Others,
}

/// What happens to landmarks that an edit does not name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Others {
    /// They stay.
    #[default]
    Keep,
    /// They leave the set.
    Retire,
}

/// What an edit changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Landmarks that are new or have another content.
    pub published: Vec<Arc<Landmark>>,
    /// Ids that left the set.
    pub retired: Vec<String>,
}

impl Change {
    /// Whether the set is as it was.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.published.is_empty() && self.retired.is_empty()
    }
}

/// Why an edit is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RefusedEdit {
    /// The landmark to be retired is not there.
    #[error("there is no landmark {id:?} to retire; the set has: {present}")]
    NotThere {
        /// Its id.
        id: String,
        /// The ids that are there.
        present: String,
    },
    /// An id is named twice.
    #[error("landmark {id:?} is named twice in one edit; name it once")]
    Twice {
        /// The id.
        id: String,
    },
    /// The set would become too large.
    #[error("the set would hold {count} landmarks; allowed: at most {MAX_LANDMARKS}")]
    TooMany {
        /// Landmarks that it would hold.
        count: usize,
    },
}

/// The set and its history within the epoch.
#[derive(Clone, Debug)]
pub struct Book {
    version: SetVersion,
    landmarks: BTreeMap<String, Arc<Landmark>>,
    /// Of landmarks that were retired: a follower ignores a revision that is not above the last it heard.
    retired_revisions: BTreeMap<String, u64>,
}

impl Book {
    /// The set that an earlier start left behind, in a new epoch.
    #[must_use]
    pub fn reopened(epoch: u64, landmarks: Vec<Arc<Landmark>>) -> Self {
        let landmarks = landmarks.into_iter().map(|landmark| (landmark.id.clone(), landmark)).collect();
        let version = SetVersion { epoch, version: 1 };
        Self { version, landmarks, retired_revisions: BTreeMap::new() }
    }

    /// The set in force.
    #[must_use]
    pub fn set(&self) -> LandmarkSet {
        LandmarkSet { version: self.version, landmarks: self.landmarks.values().cloned().collect() }
    }

    /// Makes an edit.
    ///
    /// # Errors
    /// When it cannot be made as a whole; nothing is changed then.
    pub fn apply(&mut self, edit: Edit) -> Result<Change, RefusedEdit> {
        let retired = self.leaving(&edit)?;
        let published: Vec<_> =
            edit.publish.into_iter().filter_map(|landmark| self.renewed(landmark)).collect();
        let added = published.iter().filter(|landmark| !self.landmarks.contains_key(&landmark.id)).count();
        let count = self.landmarks.len() + added - retired.len();
        if count > MAX_LANDMARKS {
            return Err(RefusedEdit::TooMany { count });
        }
        let change = Change { published, retired };
        self.make(&change);
        Ok(change)
    }

    fn make(&mut self, change: &Change) {
        for id in &change.retired {
            if let Some(landmark) = self.landmarks.remove(id) {
                self.retired_revisions.insert(id.clone(), landmark.revision);
            }
        }
        for landmark in &change.published {
            self.landmarks.insert(landmark.id.clone(), Arc::clone(landmark));
        }
        if !change.is_empty() {
            self.version.version += 1;
        }
    }

    /// Ids that leave, each of which is there and named once.
    fn leaving(&self, edit: &Edit) -> Result<Vec<String>, RefusedEdit> {
        let mut named = BTreeSet::new();
        for id in edit.publish.iter().map(|landmark| &landmark.id).chain(&edit.retire) {
            if !named.insert(id.as_str()) {
                return Err(RefusedEdit::Twice { id: id.clone() });
            }
        }
        if let Some(id) = edit.retire.iter().find(|id| !self.landmarks.contains_key(*id)) {
            let present = self.landmarks.keys().take(20).cloned().collect::<Vec<_>>().join(", ");
            return Err(RefusedEdit::NotThere { id: id.clone(), present });
        }
        let mut leaving = edit.retire.clone();
        if edit.others == Others::Retire {
            leaving.extend(self.landmarks.keys().filter(|id| !named.contains(id.as_str())).cloned());
        }
        Ok(leaving)
    }

    /// The landmark with its next revision, `None` when its content is in force already.
    fn renewed(&self, landmark: Landmark) -> Option<Arc<Landmark>> {
        let known = self.landmarks.get(&landmark.id);
        if known.is_some_and(|known| known.digest == landmark.digest) {
            return None;
        }
        let last =
            known.map(|known| known.revision).or_else(|| self.retired_revisions.get(&landmark.id).copied());
        let revision = last.unwrap_or(0).saturating_add(1);
        Some(Arc::new(Landmark { revision, ..landmark }))
    }
}

#[cfg(test)]
mod tests {
    use vision::{ColorStats, Digest, ShapeClass, WindowPx};
    use waymark_proto::digest::landmark_digest;

    use super::*;

    fn landmark(id: &str, red: f32) -> Landmark {
        let mut landmark = Landmark {
            id: id.into(),
            revision: 0,
            window_px: WindowPx::square(12),
            shades: vec![ColorStats::uniform(red, 10.0)],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Any,
            size_m: None,
            digest: Digest::default(),
        };
        landmark.digest = landmark_digest(&landmark);
        landmark
    }

    fn publish(landmarks: &[Landmark]) -> Edit {
        Edit { publish: landmarks.to_vec(), ..Edit::default() }
    }

    fn retire(id: &str) -> Edit {
        Edit { retire: vec![id.into()], ..Edit::default() }
    }

    fn book() -> Book {
        let mut book = Book::reopened(3, Vec::new());
        book.apply(publish(&[landmark("blue", 1.0), landmark("red", 2.0)])).unwrap();
        book
    }

    #[test]
    fn the_set_is_sorted_and_versioned() {
        let set = book().set();
        assert_eq!(set.version, SetVersion { epoch: 3, version: 2 });
        let ids: Vec<_> = set.landmarks.iter().map(|landmark| landmark.id.as_str()).collect();
        assert_eq!(ids, ["blue", "red"]);
        assert!(set.landmarks.iter().all(|landmark| landmark.revision == 1));
    }

    #[test]
    fn only_another_content_is_a_change() {
        let mut book = book();
        assert!(book.apply(publish(&[landmark("red", 2.0)])).unwrap().is_empty());
        assert_eq!(book.set().version.version, 2);
        let change = book.apply(publish(&[landmark("red", 9.0)])).unwrap();
        assert_eq!(change.published[0].revision, 2);
        assert_eq!(book.set().version.version, 3);
    }

    #[test]
    fn a_landmark_that_returns_has_a_higher_revision() {
        let mut book = book();
        assert_eq!(book.apply(retire("red")).unwrap().retired, ["red"]);
        let change = book.apply(publish(&[landmark("red", 2.0)])).unwrap();
        assert_eq!(change.published[0].revision, 2);
    }

    #[test]
    fn a_refused_edit_changes_nothing() {
        let mut book = book();
        let before = book.set();
        let edit = Edit { retire: vec!["green".into()], ..publish(&[landmark("new", 1.0)]) };
        let refused = book.apply(edit).unwrap_err().to_string();
        assert_eq!(refused, "there is no landmark \"green\" to retire; the set has: blue, red");
        let twice = Edit { retire: vec!["red".into()], ..publish(&[landmark("red", 1.0)]) };
        assert!(matches!(book.apply(twice), Err(RefusedEdit::Twice { .. })));
        assert_eq!(book.set(), before);
    }

    #[test]
    fn a_whole_set_takes_the_place_of_another() {
        let mut book = book();
        let edit = Edit { others: Others::Retire, ..publish(&[landmark("blue", 1.0), landmark("new", 5.0)]) };
        let change = book.apply(edit).unwrap();
        assert_eq!((change.published.len(), change.retired), (1, vec!["red".to_owned()]));
        assert_eq!(book.set().landmarks.len(), 2);
    }

    #[test]
    fn a_set_has_a_bound() {
        let many: Vec<_> = (0..=MAX_LANDMARKS).map(|number| landmark(&format!("l{number}"), 1.0)).collect();
        let refused = Book::reopened(1, Vec::new()).apply(publish(&many)).unwrap_err();
        assert_eq!(refused, RefusedEdit::TooMany { count: MAX_LANDMARKS + 1 });
    }
}
