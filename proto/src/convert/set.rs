//! Landmark sets and the manifests that describe them.

use std::sync::Arc;

use vision::{Digest, LandmarkSet, SetVersion};

use super::check::{InvalidField, digest, present};
use super::landmark::{landmark_from_wire, landmark_to_wire};
use crate::digest::set_digest;
use crate::v1;

/// What a manifest says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manifest {
    /// The state of the leader's set.
    pub version: SetVersion,
    /// Landmarks in it.
    pub count: u32,
    /// Digest of all of them.
    pub digest: Digest,
}

impl Manifest {
    /// Whether `set` holds exactly the landmarks that this manifest describes, whatever version it claims.
    #[must_use]
    pub fn describes(&self, set: &LandmarkSet) -> bool {
        self.count as usize == set.landmarks.len()
            && self.digest == set_digest(set.landmarks.iter().map(|landmark| landmark.digest))
    }
}

/// The manifest of a set.
#[must_use]
pub fn manifest_of(set: &LandmarkSet) -> v1::LandmarkManifest {
    v1::LandmarkManifest {
        epoch: set.version.epoch,
        version: set.version.version,
        count: u32::try_from(set.landmarks.len()).unwrap_or(u32::MAX),
        digest: set_digest(set.landmarks.iter().map(|landmark| landmark.digest)).0.to_vec(),
    }
}

/// What a manifest says.
///
/// # Errors
/// When its digest is none.
pub fn manifest_from_wire(wire: &v1::LandmarkManifest) -> Result<Manifest, InvalidField> {
    Ok(Manifest {
        version: SetVersion { epoch: wire.epoch, version: wire.version },
        count: wire.count,
        digest: digest("digest", &wire.digest)?,
    })
}

/// The wire's form of a whole set. Its landmarks carry the set's epoch: followers order revisions within it.
#[must_use]
pub fn set_to_wire(set: &LandmarkSet) -> v1::LandmarkSet {
    let epoch = set.version.epoch;
    v1::LandmarkSet {
        manifest: Some(manifest_of(set)),
        landmarks: set.landmarks.iter().map(|landmark| landmark_to_wire(landmark, epoch)).collect(),
    }
}

/// A whole set.
///
/// # Errors
/// The first field that is not allowed; also when the landmarks are not sorted by id, or are not those that the
/// manifest describes.
pub fn set_from_wire(wire: &v1::LandmarkSet) -> Result<LandmarkSet, InvalidField> {
    let manifest = manifest_from_wire(present("manifest", wire.manifest.as_ref())?)
        .map_err(|invalid| invalid.inside("manifest"))?;
    let mut set = LandmarkSet { version: manifest.version, landmarks: Vec::new() };
    for (at, landmark) in wire.landmarks.iter().enumerate() {
        let (landmark, _epoch) = landmark_from_wire(landmark)
            .map_err(|invalid| invalid.inside(format_args!("landmarks[{at}]")))?;
        if set.landmarks.last().is_some_and(|previous| previous.id >= landmark.id) {
            let field = format_args!("landmarks[{at}].id");
            return Err(InvalidField::new(field, &landmark.id, "ids that rise from landmark to landmark"));
        }
        set.landmarks.push(Arc::new(landmark));
    }
    if !manifest.describes(&set) {
        let found = manifest_from_wire(&manifest_of(&set))?;
        let value = format_args!("{} of {} landmarks", manifest.digest, manifest.count);
        let allowed = format_args!("that of the landmarks sent: {} of {}", found.digest, found.count);
        return Err(InvalidField::new("manifest.digest", value, allowed));
    }
    Ok(set)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::arbitrary::sets;

    proptest! {
        #[test]
        fn every_set_survives_the_wire(set in sets()) {
            prop_assert_eq!(set_from_wire(&set_to_wire(&set)), Ok(set));
        }

        #[test]
        fn a_set_that_lacks_a_landmark_is_not_what_its_manifest_describes(set in sets(), at: prop::sample::Index) {
            prop_assume!(!set.landmarks.is_empty());
            let mut wire = set_to_wire(&set);
            wire.landmarks.remove(at.index(set.landmarks.len()));
            prop_assert_eq!(set_from_wire(&wire).unwrap_err().field, "manifest.digest");
        }
    }

    #[test]
    fn the_field_is_named_from_the_set_down() {
        let landmark = v1::Landmark { revision: 1, id: "a".into(), ..Default::default() };
        let wire = v1::LandmarkSet {
            manifest: Some(v1::LandmarkManifest { digest: vec![0; 32], ..Default::default() }),
            landmarks: vec![landmark],
        };
        assert_eq!(set_from_wire(&wire).unwrap_err().field, "landmarks[0].window_width_px");
        let no_digest =
            v1::LandmarkSet { manifest: Some(v1::LandmarkManifest::default()), landmarks: vec![] };
        assert_eq!(set_from_wire(&no_digest).unwrap_err().field, "manifest.digest");
        assert_eq!(set_from_wire(&v1::LandmarkSet::default()).unwrap_err().field, "manifest");
    }
}
