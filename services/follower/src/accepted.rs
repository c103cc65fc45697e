//! Which landmarks a follower holds: a state machine over what the leader says, without clock or network.
//!
//! The leader announces single landmarks as they change and, once a second, a manifest of the whole set. Single
//! landmarks are taken at once; the manifest decides what the set is. A set that differs from its manifest is fetched
//! whole, and what the fetched set lacks is retired. Everything older than what is known is ignored.

use std::collections::BTreeMap;
use std::sync::Arc;

use vision::{Landmark, LandmarkSet, SetVersion};
use waymark_proto::convert::Manifest;

/// What became of an offered landmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// It is in force now.
    Accepted,
    /// It was in force already.
    Known,
    /// A newer one is in force.
    Older,
    /// Another content under the same revision: the first one stays.
    Conflict,
}

/// What a manifest says about the set that is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// The set is the leader's.
    Complete,
    /// The manifest is older than what is known.
    Older,
    /// The set differs: fetch it.
    Differs,
}

/// The landmarks in force.
#[derive(Clone, Debug, Default)]
pub struct AcceptedSet {
    version: SetVersion,
    landmarks: BTreeMap<String, Held>,
}

#[derive(Clone, Debug)]
struct Held {
    epoch: u64,
    landmark: Arc<Landmark>,
}

impl AcceptedSet {
    /// The set of an earlier run, in force until the leader says otherwise.
    #[must_use]
    pub fn restored(set: &LandmarkSet) -> Self {
        let epoch = set.version.epoch;
        let held = |landmark: &Arc<Landmark>| Held { epoch, landmark: Arc::clone(landmark) };
        let landmarks = set.landmarks.iter().map(|landmark| (landmark.id.clone(), held(landmark))).collect();
        Self { version: set.version, landmarks }
    }

    /// Takes one landmark as its leader announces it.
    pub fn offer(&mut self, epoch: u64, landmark: Landmark) -> Offer {
        let offered = (epoch, landmark.revision);
        if epoch < self.version.epoch {
            return Offer::Older;
        }
        if let Some(known) = self.landmarks.get(&landmark.id) {
            match offered.cmp(&(known.epoch, known.landmark.revision)) {
                std::cmp::Ordering::Less => return Offer::Older,
                std::cmp::Ordering::Equal if known.landmark.digest == landmark.digest => return Offer::Known,
                std::cmp::Ordering::Equal => return Offer::Conflict,
                std::cmp::Ordering::Greater => {}
            }
        }
        self.landmarks.insert(landmark.id.clone(), Held { epoch, landmark: Arc::new(landmark) });
        Offer::Accepted
    }

    /// Compares the set with its leader's manifest; a complete set takes over the manifest's version.
    pub fn compare(&mut self, manifest: &Manifest) -> Comparison {
        if manifest.version < self.version {
            return Comparison::Older;
        }
        if !manifest.describes(&self.set()) {
            return Comparison::Differs;
        }
        self.version = manifest.version;
        Comparison::Complete
    }

    /// Puts the fetched landmarks in place of the held ones when they are what the manifest announces. Returns whether
    /// they were.
    pub fn replace(&mut self, manifest: &Manifest, fetched: Vec<(Landmark, u64)>) -> bool {
        let held = |(landmark, epoch): (Landmark, u64)| {
            (landmark.id.clone(), Held { epoch, landmark: Arc::new(landmark) })
        };
        let candidate =
            Self { version: manifest.version, landmarks: fetched.into_iter().map(held).collect() };
        if manifest.version < self.version || !manifest.describes(&candidate.set()) {
            return false;
        }
        *self = candidate;
        true
    }

    /// The set in the form that [`vision::follow::Follow`] takes.
    #[must_use]
    pub fn set(&self) -> LandmarkSet {
        let landmarks = self.landmarks.values().map(|held| Arc::clone(&held.landmark)).collect();
        LandmarkSet { version: self.version, landmarks }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use vision::{ColorStats, Digest, ShapeClass, WindowPx};
    use waymark_proto::digest;

    pub(crate) fn landmark(id: &str, revision: u64, red: f32) -> Landmark {
        let mut landmark = Landmark {
            id: id.to_owned(),
            revision,
            window_px: WindowPx::square(12),
            shades: vec![ColorStats::uniform(red, 20.0)],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Block,
            size_m: None,
            digest: Digest::default(),
        };
        landmark.digest = digest::landmark_digest(&landmark);
        landmark
    }

    fn manifest(epoch: u64, version: u64, landmarks: &[&Landmark]) -> Manifest {
        Manifest {
            version: SetVersion { epoch, version },
            count: landmarks.len() as u32,
            digest: digest::set_digest(landmarks.iter().map(|landmark| landmark.digest)),
        }
    }

    #[test]
    fn a_complete_set_takes_over_the_version() {
        let red = landmark("red", 1, 200.0);
        let mut set = AcceptedSet::default();
        assert_eq!(set.compare(&manifest(1, 1, &[&red])), Comparison::Differs);
        assert_eq!(set.offer(1, red.clone()), Offer::Accepted);
        assert_eq!(set.compare(&manifest(1, 1, &[&red])), Comparison::Complete);
        assert_eq!(set.set().version, SetVersion { epoch: 1, version: 1 });
        assert_eq!(set.offer(1, red), Offer::Known);
    }

    #[test]
    fn older_and_conflicting_offers_change_nothing() {
        let mut set = AcceptedSet::default();
        set.offer(2, landmark("red", 5, 200.0));
        let before = set.set();
        assert_eq!(set.offer(2, landmark("red", 4, 100.0)), Offer::Older);
        assert_eq!(set.offer(1, landmark("red", 9, 100.0)), Offer::Older);
        assert_eq!(set.offer(2, landmark("red", 5, 100.0)), Offer::Conflict);
        assert_eq!(set.set(), before);
        assert_eq!(set.offer(3, landmark("red", 1, 100.0)), Offer::Accepted, "a new epoch counts anew");
    }

    #[test]
    fn a_fetched_set_retires_what_it_lacks_and_must_match_its_manifest() {
        let (red, blue) = (landmark("red", 1, 200.0), landmark("blue", 1, 50.0));
        let mut set = AcceptedSet::default();
        set.offer(1, red.clone());
        set.offer(1, blue.clone());
        let only_blue = manifest(1, 3, &[&blue]);
        assert_eq!(set.compare(&only_blue), Comparison::Differs);
        assert!(!set.replace(&only_blue, vec![(red, 1)]), "half a set is no set");
        assert_eq!(set.set().landmarks.len(), 2);
        assert!(set.replace(&only_blue, vec![(blue, 1)]));
        assert_eq!(set.set().landmarks.len(), 1);
        assert_eq!(set.compare(&manifest(1, 2, &[])), Comparison::Older);
    }
}
