//! Payloads of the leader, believed only after every check.

use vision::Landmark;
use waymark_proto::convert::{self, InvalidField, Manifest};
use waymark_proto::payload::{RefusedPayload, WireMessage};
use waymark_proto::v1;

/// Why a payload changes nothing.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Refused {
    /// It cannot be decoded.
    #[error(transparent)]
    Payload(#[from] RefusedPayload),
    /// It says something impossible.
    #[error(transparent)]
    Field(#[from] InvalidField),
}

/// A landmark with the epoch of its publication.
pub(crate) fn landmark(payload: &[u8]) -> Result<(Landmark, u64), Refused> {
    Ok(convert::landmark_from_wire(&v1::Landmark::from_payload(payload)?)?)
}

/// A manifest.
pub(crate) fn manifest(payload: &[u8]) -> Result<Manifest, Refused> {
    Ok(convert::manifest_from_wire(&v1::LandmarkManifest::from_payload(payload)?)?)
}
