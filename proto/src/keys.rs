//! Every key expression of Waymark: `waymark/v1/{fleet}/{vehicle}/{resource}`.
//!
//! ```
//! use waymark_proto::keys::{CameraStream, Id, Key, Resource, VehicleKeys};
//!
//! let keys = VehicleKeys::new("rink", "v1")?;
//! let front = Id::new("camera", "front")?;
//! let image = keys.key(Resource::Camera(front, CameraStream::Image));
//! assert_eq!(image.to_string(), "waymark/v1/rink/v1/camera/front/image");
//! assert_eq!(image.to_string().parse::<Key>()?, image);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod id;
mod presence;
mod select;

use std::fmt;
use std::str::FromStr;

pub use id::{Id, InvalidId};
pub use presence::{PresenceKey, Role};
pub use select::VehicleKeys;

/// What every data key begins with; raised when the meaning of a key changes.
pub const ROOT: &str = "waymark/v1";

/// One key: whose it is, and what it holds.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    /// The fleet.
    pub fleet: Id,
    /// The vehicle within the fleet.
    pub vehicle: Id,
    /// What stands below the vehicle.
    pub resource: Resource,
}

/// What stands below a vehicle's root.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Resource {
    /// A `waymark.v1.Landmark`.
    Landmark(Id),
    /// A query carries a `waymark.v1.LandmarkEdit`; the leader answers with a `waymark.v1.LandmarkEditReply`.
    LandmarkEdit,
    /// The `waymark.v1.LandmarkManifest`.
    Manifest,
    /// One of the streams of one camera.
    Camera(Id, CameraStream),
    /// A keyframe of a taught route (reserved).
    Keyframe {
        /// The route.
        route: Id,
        /// Counts from 0 along the route.
        number: u32,
    },
    /// The vehicle's own motion (reserved).
    Odometry,
    /// Where to steer (reserved).
    Guidance,
    /// A `waymark.v1.VehicleStatus`.
    Status,
    /// What a diagnosis says to itself to see whether it comes back; anything, and of no meaning to others.
    Echo(Id),
}

/// The streams of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CameraStream {
    /// `foxglove.CompressedImage`, `foxglove.RawImage` or `foxglove.CompressedVideo`.
    Image,
    /// `foxglove.CameraCalibration`.
    Calibration,
    /// `waymark.v1.Registration`.
    Registration,
    /// `foxglove.ImageAnnotations`.
    Annotations,
    /// `waymark.v1.Truth`, from simulators only.
    Truth,
}

impl CameraStream {
    /// All streams.
    pub const ALL: [Self; 5] =
        [Self::Image, Self::Calibration, Self::Registration, Self::Annotations, Self::Truth];

    /// The last chunk of the key.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Image => "image",
            Self::Calibration => "calibration",
            Self::Registration => "registration",
            Self::Annotations => "annotations",
            Self::Truth => "truth",
        }
    }
}

impl fmt::Display for Resource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Landmark(id) => write!(f, "landmark/{id}"),
            Self::LandmarkEdit => f.write_str("landmark-edit"),
            Self::Manifest => f.write_str("manifest"),
            Self::Camera(camera, stream) => write!(f, "camera/{camera}/{}", stream.name()),
            Self::Keyframe { route, number } => write!(f, "route/{route}/{number}"),
            Self::Odometry => f.write_str("odometry"),
            Self::Guidance => f.write_str("guidance"),
            Self::Status => f.write_str("status"),
            Self::Echo(id) => write!(f, "echo/{id}"),
        }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{ROOT}/{}/{}/{}", self.fleet, self.vehicle, self.resource)
    }
}

/// A key expression that is none of ours.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnknownKey {
    /// It has another root or another layout.
    #[error("{0:?} is no key of Waymark: expected {ROOT}/{{fleet}}/{{vehicle}}/{{resource}}")]
    Layout(String),
    /// One of its ids is none.
    #[error("{key:?}: {invalid}")]
    Id {
        /// The key.
        key: String,
        /// What is wrong with it.
        invalid: InvalidId,
    },
}

impl FromStr for Key {
    type Err = UnknownKey;

    fn from_str(key: &str) -> Result<Self, UnknownKey> {
        let layout = || UnknownKey::Layout(key.to_owned());
        let below_root = key.strip_prefix(ROOT).and_then(|rest| rest.strip_prefix('/')).ok_or_else(layout)?;
        let chunks: Vec<&str> = below_root.splitn(3, '/').collect();
        let &[fleet, vehicle, resource] = chunks.as_slice() else { return Err(layout()) };
        let parsed = || -> Result<Option<Self>, InvalidId> {
            let (fleet, vehicle) = (Id::new("fleet", fleet)?, Id::new("vehicle", vehicle)?);
            Ok(Resource::parse(resource)?.map(|resource| Self { fleet, vehicle, resource }))
        };
        parsed().map_err(|invalid| UnknownKey::Id { key: key.to_owned(), invalid })?.ok_or_else(layout)
    }
}

impl Resource {
    fn parse(below_vehicle: &str) -> Result<Option<Self>, InvalidId> {
        let chunks: Vec<&str> = below_vehicle.split('/').collect();
        Ok(match chunks.as_slice() {
            ["landmark", id] => Some(Self::Landmark(Id::new("landmark", id)?)),
            ["landmark-edit"] => Some(Self::LandmarkEdit),
            ["manifest"] => Some(Self::Manifest),
            ["camera", camera, stream] => {
                let camera = Id::new("camera", camera)?;
                let stream = CameraStream::ALL.into_iter().find(|known| known.name() == *stream);
                stream.map(|stream| Self::Camera(camera, stream))
            }
            ["route", route, number] => {
                let route = Id::new("route", route)?;
                number.parse().ok().map(|number| Self::Keyframe { route, number })
            }
            ["odometry"] => Some(Self::Odometry),
            ["guidance"] => Some(Self::Guidance),
            ["status"] => Some(Self::Status),
            ["echo", id] => Some(Self::Echo(Id::new("echo", id)?)),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ids() -> impl Strategy<Value = Id> {
        "[a-z0-9][a-z0-9_-]{0,62}".prop_map(|id| Id::new("id", &id).unwrap())
    }

    fn resources() -> impl Strategy<Value = Resource> {
        prop_oneof![
            ids().prop_map(Resource::Landmark),
            ids().prop_map(Resource::Echo),
            (ids(), prop::sample::select(CameraStream::ALL.to_vec()))
                .prop_map(|(camera, stream)| Resource::Camera(camera, stream)),
            (ids(), any::<u32>()).prop_map(|(route, number)| Resource::Keyframe { route, number }),
            prop::sample::select(vec![
                Resource::LandmarkEdit,
                Resource::Manifest,
                Resource::Odometry,
                Resource::Guidance,
                Resource::Status,
            ]),
        ]
    }

    proptest! {
        #[test]
        fn every_key_is_read_back(fleet in ids(), vehicle in ids(), resource in resources()) {
            let key = Key { fleet, vehicle, resource };
            prop_assert_eq!(key.to_string().parse::<Key>(), Ok(key));
        }

        #[test]
        fn no_string_makes_the_parser_panic(key in "\\PC*") {
            let _ = key.parse::<Key>();
        }
    }

    #[test]
    fn other_roots_layouts_and_ids_are_refused() {
        for key in ["", "waymark/v1", "waymark/v2/f/v/status", "waymark/v1/f/v", "waymark/v1/f/v/other"] {
            assert!(matches!(key.parse::<Key>(), Err(UnknownKey::Layout(_))), "{key}");
        }
        for key in ["waymark/v1/F/v/status", "waymark/v1/f/v/landmark/*", "waymark/v1/f/v/camera/a.b/image"] {
            assert!(matches!(key.parse::<Key>(), Err(UnknownKey::Id { .. })), "{key}");
        }
        let refused = "waymark/v1/f/v/landmark/..".parse::<Key>().unwrap_err();
        assert!(refused.to_string().contains("landmark is \"..\""), "{refused}");
    }
}
