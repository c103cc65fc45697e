//! The sets that a store keeps, in memory and on disk.

use std::collections::BTreeMap;
use std::fs;
use std::io;

use prost::Message;
use runtime::StateDir;
use vision::LandmarkSet;
use waymark_proto::convert::{Manifest, set_from_wire, set_to_wire};
use waymark_proto::keys::{InvalidId, VehicleKeys};
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;

use crate::error::LeaderError;
use crate::publication::Publication;

/// Vehicles whose sets are kept; more are not, so that invented ones cannot fill memory and disk.
const MAX_VEHICLES: usize = 256;
const EXTENSION: &str = "landmarks";

/// The newest set of each vehicle.
#[derive(Clone, Debug, Default)]
pub struct Shelf {
    sets: BTreeMap<VehicleKeys, Publication>,
}

/// What became of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filed {
    /// It is kept, or an equally new one is.
    Kept,
    /// There are too many vehicles.
    NoRoom,
}

impl Shelf {
    /// What an earlier start left on disk. A damaged file is passed over: its leader, or another store, still has it.
    pub(super) fn read(state: &StateDir) -> Result<Self, LeaderError> {
        let unreadable = |reason: io::Error| LeaderError::Memory {
            path: state.path().to_owned(),
            reason: reason.to_string(),
        };
        let mut shelf = Self::default();
        for entry in fs::read_dir(state.path()).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            if path.extension().is_none_or(|extension| extension != EXTENSION) {
                continue;
            }
            let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            match read_set(&path, &stem) {
                Ok((vehicle, set)) => drop(shelf.put(&vehicle, set)),
                Err(reason) => tracing::error!(path = %path.display(), reason, "a kept set cannot be used"),
            }
        }
        Ok(shelf)
    }

    /// Whether the set that `manifest` describes, or a newer one, is here.
    pub(super) fn is_current(&self, vehicle: &VehicleKeys, manifest: &Manifest) -> bool {
        self.sets.get(vehicle).is_some_and(|kept| {
            let known = kept.set.version;
            known > manifest.version || (known == manifest.version && manifest.describes(&kept.set))
        })
    }

    /// Keeps a set, unless a newer one is here.
    pub(super) fn put(&mut self, vehicle: &VehicleKeys, set: LandmarkSet) -> Result<Filed, InvalidId> {
        let known = self.sets.get(vehicle);
        if known.is_some_and(|kept| kept.set.version > set.version) {
            return Ok(Filed::Kept);
        }
        if known.is_none() && self.sets.len() >= MAX_VEHICLES {
            return Ok(Filed::NoRoom);
        }
        self.sets.insert(vehicle.clone(), Publication::of(set, vehicle)?);
        Ok(Filed::Kept)
    }

    pub(super) fn sets(&self) -> impl Iterator<Item = (&VehicleKeys, &Publication)> {
        self.sets.iter()
    }

    /// Vehicles and how many landmarks each has.
    pub fn vehicles(&self) -> impl Iterator<Item = (&VehicleKeys, usize)> {
        self.sets.iter().map(|(vehicle, kept)| (vehicle, kept.set.landmarks.len()))
    }
}

/// Writes a set in the place of the vehicle's earlier one.
pub(super) fn write(state: &StateDir, vehicle: &VehicleKeys, set: &LandmarkSet) -> io::Result<()> {
    let name = format!("{}.{}.{EXTENSION}", vehicle.fleet(), vehicle.vehicle());
    state.replace(&name, &set_to_wire(set).encode_to_vec())
}

/// Ids have no dot, so a file's name tells fleet and vehicle apart.
fn read_set(path: &std::path::Path, stem: &str) -> Result<(VehicleKeys, LandmarkSet), String> {
    let (fleet, vehicle) = stem.split_once('.').ok_or("its name is not FLEET.VEHICLE.landmarks")?;
    let vehicle = VehicleKeys::new(fleet, vehicle).map_err(|error| error.to_string())?;
    let bytes = fs::read(path).map_err(|error| error.to_string())?;
    let wire = v1::LandmarkSet::from_payload(&bytes).map_err(|error| error.to_string())?;
    Ok((vehicle, set_from_wire(&wire).map_err(|error| error.to_string())?))
}

#[cfg(test)]
mod tests {
    use vision::{Digest, SetVersion};
    use waymark_proto::digest::set_digest;

    use super::*;

    fn vehicle(number: usize) -> VehicleKeys {
        VehicleKeys::new("convoy", &format!("v{number}")).unwrap()
    }

    fn set(epoch: u64) -> LandmarkSet {
        LandmarkSet { version: SetVersion { epoch, version: 1 }, landmarks: Vec::new() }
    }

    #[test]
    fn older_sets_do_not_replace_newer_ones() {
        let mut shelf = Shelf::default();
        shelf.put(&vehicle(1), set(2)).unwrap();
        shelf.put(&vehicle(1), set(1)).unwrap();
        let digest = set_digest([]);
        let manifest = |epoch| Manifest { version: set(epoch).version, count: 0, digest };
        assert!(shelf.is_current(&vehicle(1), &manifest(1)));
        assert!(shelf.is_current(&vehicle(1), &manifest(2)));
        assert!(!shelf.is_current(&vehicle(1), &manifest(3)));
        assert!(!shelf.is_current(&vehicle(2), &manifest(1)));
        let other = Manifest { digest: Digest([1; 32]), ..manifest(2) };
        assert!(!shelf.is_current(&vehicle(1), &other));
    }

    #[test]
    fn vehicles_have_a_bound() {
        let mut shelf = Shelf::default();
        for number in 0..MAX_VEHICLES {
            assert_eq!(shelf.put(&vehicle(number), set(1)), Ok(Filed::Kept));
        }
        assert_eq!(shelf.put(&vehicle(MAX_VEHICLES), set(1)), Ok(Filed::NoRoom));
        assert_eq!(shelf.put(&vehicle(0), set(2)), Ok(Filed::Kept));
    }

    #[test]
    fn what_was_written_is_read_and_what_is_damaged_passed_over() {
        let place = tempfile::tempdir().unwrap();
        let state = StateDir::open(place.path()).unwrap();
        write(&state, &vehicle(1), &set(7)).unwrap();
        fs::write(place.path().join("convoy.v2.landmarks"), "no message").unwrap();
        fs::write(place.path().join("nobody.landmarks"), "").unwrap();
        let shelf = Shelf::read(&state).unwrap();
        let vehicles: Vec<_> =
            shelf.sets().map(|(vehicle, kept)| (vehicle, kept.set.version.epoch)).collect();
        assert_eq!(vehicles, [(&vehicle(1), 7)]);
    }
}
