//! Key expressions of one vehicle, single and with wildcards.

use super::{CameraStream, Id, InvalidId, Key, ROOT, Resource};

/// Builds the key expressions of one vehicle.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VehicleKeys {
    fleet: Id,
    vehicle: Id,
}

impl VehicleKeys {
    /// The keys of `vehicle` in `fleet`.
    ///
    /// # Errors
    /// When one of them is no [`Id`].
    pub fn new(fleet: &str, vehicle: &str) -> Result<Self, InvalidId> {
        Ok(Self { fleet: Id::new("fleet", fleet)?, vehicle: Id::new("vehicle", vehicle)? })
    }

    /// The keys of the vehicle that `key` belongs to.
    #[must_use]
    pub fn of_key(key: &Key) -> Self {
        Self { fleet: key.fleet.clone(), vehicle: key.vehicle.clone() }
    }

    /// The fleet.
    #[must_use]
    pub fn fleet(&self) -> &Id {
        &self.fleet
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(&self) -> &Id {
        &self.vehicle
    }

    /// The key of `resource`.
    #[must_use]
    pub fn key(&self, resource: Resource) -> Key {
        Key { fleet: self.fleet.clone(), vehicle: self.vehicle.clone(), resource }
    }

    /// The key expression of one landmark.
    #[must_use]
    pub fn landmark(&self, id: &Id) -> String {
        self.key(Resource::Landmark(id.clone())).to_string()
    }

    /// All landmarks of this vehicle.
    #[must_use]
    pub fn landmarks(&self) -> String {
        format!("{}/landmark/**", self.root())
    }

    /// Where changes of the landmark set are asked for.
    #[must_use]
    pub fn landmark_edit(&self) -> String {
        self.key(Resource::LandmarkEdit).to_string()
    }

    /// The manifest of the landmark set.
    #[must_use]
    pub fn manifest(&self) -> String {
        self.key(Resource::Manifest).to_string()
    }

    /// One stream of one camera.
    #[must_use]
    pub fn camera(&self, camera: &Id, stream: CameraStream) -> String {
        self.key(Resource::Camera(camera.clone(), stream)).to_string()
    }

    /// One stream of all cameras.
    #[must_use]
    pub fn cameras(&self, stream: CameraStream) -> String {
        format!("{}/camera/*/{}", self.root(), stream.name())
    }

    /// The vehicle's status.
    #[must_use]
    pub fn status(&self) -> String {
        self.key(Resource::Status).to_string()
    }

    /// Where this vehicle's diagnoses speak to themselves.
    #[must_use]
    pub fn echoes(&self) -> String {
        format!("{}/echo/*", self.root())
    }

    /// The status of every vehicle of this fleet.
    #[must_use]
    pub fn fleet_status(&self) -> String {
        format!("{ROOT}/{}/*/status", self.fleet)
    }

    /// Every landmark of every vehicle of every fleet: what a store keeps.
    #[must_use]
    pub fn every_landmark() -> String {
        format!("{ROOT}/*/*/landmark/**")
    }

    /// The manifest of every vehicle of every fleet: what a store keeps.
    #[must_use]
    pub fn every_manifest() -> String {
        format!("{ROOT}/*/*/manifest")
    }

    fn root(&self) -> String {
        format!("{ROOT}/{}/{}", self.fleet, self.vehicle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_are_those_of_the_contract() {
        let keys = VehicleKeys::new("rink", "v1").unwrap();
        let (front, red) = (Id::new("camera", "front").unwrap(), Id::new("landmark", "red").unwrap());
        assert_eq!(keys.landmark(&red), "waymark/v1/rink/v1/landmark/red");
        assert_eq!(keys.landmarks(), "waymark/v1/rink/v1/landmark/**");
        assert_eq!(keys.landmark_edit(), "waymark/v1/rink/v1/landmark-edit");
        assert_eq!(keys.manifest(), "waymark/v1/rink/v1/manifest");
        assert_eq!(keys.camera(&front, CameraStream::Truth), "waymark/v1/rink/v1/camera/front/truth");
        assert_eq!(keys.cameras(CameraStream::Image), "waymark/v1/rink/v1/camera/*/image");
        assert_eq!(keys.status(), "waymark/v1/rink/v1/status");
        assert_eq!(keys.echoes(), "waymark/v1/rink/v1/echo/*");
        assert_eq!(keys.fleet_status(), "waymark/v1/rink/*/status");
        assert_eq!(VehicleKeys::every_landmark(), "waymark/v1/*/*/landmark/**");
        assert_eq!(VehicleKeys::every_manifest(), "waymark/v1/*/*/manifest");
    }
}
