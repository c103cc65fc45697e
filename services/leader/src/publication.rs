//! A set as the messages that tell of it, encoded once for everyone who listens or asks.

use std::collections::BTreeMap;
use std::sync::Arc;

use prost::Message;
use vision::LandmarkSet;
use waymark_proto::convert::{landmark_to_wire, manifest_of};
use waymark_proto::keys::{InvalidId, Key, Resource, VehicleKeys};
use zenoh::bytes::ZBytes;
use zenoh::key_expr::KeyExpr;

/// One state of the set, ready to be sent.
#[derive(Clone, Debug)]
pub(crate) struct Publication {
    pub(crate) set: Arc<LandmarkSet>,
    pub(crate) manifest: ZBytes,
    landmarks: BTreeMap<String, Sendable>,
}

/// One landmark, ready to be sent.
#[derive(Clone, Debug)]
pub(crate) struct Sendable {
    pub(crate) key: KeyExpr<'static>,
    pub(crate) payload: ZBytes,
}

impl Publication {
    pub(crate) fn of(set: LandmarkSet, keys: &VehicleKeys) -> Result<Self, InvalidId> {
        let epoch = set.version.epoch;
        let mut landmarks = BTreeMap::new();
        for landmark in &set.landmarks {
            let payload = ZBytes::from(landmark_to_wire(landmark, epoch).encode_to_vec());
            landmarks
                .insert(landmark.id.clone(), Sendable { key: landmark_key(keys, &landmark.id)?, payload });
        }
        let manifest = ZBytes::from(manifest_of(&set).encode_to_vec());
        Ok(Self { set: Arc::new(set), manifest, landmarks })
    }

    pub(crate) fn landmark(&self, id: &str) -> Option<&Sendable> {
        self.landmarks.get(id)
    }

    pub(crate) fn landmarks(&self) -> impl Iterator<Item = &Sendable> {
        self.landmarks.values()
    }
}

/// The key expression of one landmark.
pub(crate) fn landmark_key(keys: &VehicleKeys, id: &str) -> Result<KeyExpr<'static>, InvalidId> {
    let id = waymark_proto::keys::Id::new("landmark", id)?;
    Ok(key_expr(&keys.key(Resource::Landmark(id))))
}

/// A key of ours as Zenoh's. Ids have no character that a key expression gives a meaning to.
pub(crate) fn key_expr(key: &Key) -> KeyExpr<'static> {
    KeyExpr::new(key.to_string()).expect("an id holds nothing but [a-z0-9_-], which every key expression may")
}
