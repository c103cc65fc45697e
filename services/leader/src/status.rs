//! How a leader is, as JSON (contract section 8) and as a message.

use schemars::JsonSchema;
use serde::Serialize;
use waymark_proto::v1;

use crate::put_times::PutStatus;

/// What a leader says of itself.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct LeaderStatus {
    /// The vehicle's id.
    pub(crate) vehicle: String,
    /// Always `leader`.
    pub(crate) role: &'static str,
    /// Version of the program.
    pub(crate) version: &'static str,
    /// Which process this is.
    pub(crate) instance: String,
    /// Seconds since the start.
    pub(crate) uptime_s: f64,
    /// The way to the others.
    pub(crate) router: RouterStatus,
    /// Landmarks in force.
    pub(crate) landmarks: usize,
    /// The set in force.
    pub(crate) set: SetStatus,
    /// Changes asked for since the start, by what came of them.
    pub(crate) edits: EditCounts,
    /// What its own puts take.
    pub(crate) puts: PutStatus,
    /// Cameras that people look through to teach it landmarks.
    pub(crate) cameras: Vec<CameraStatus>,
}

/// A camera that people look through.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct CameraStatus {
    /// The camera's id.
    pub(crate) id: String,
    /// `waiting`, `live` or `stale`.
    pub(crate) state: &'static str,
    /// Number of the newest frame.
    pub(crate) sequence: Option<u64>,
    /// Age of the newest frame since its arrival, ms.
    pub(crate) age_ms: Option<f64>,
}

/// The way to the others.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub(crate) struct RouterStatus {
    /// Whether at least one router is connected.
    pub(crate) connected: bool,
}

/// Which state of the set is in force.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub(crate) struct SetStatus {
    /// Counts starts.
    pub(crate) epoch: u64,
    /// Counts changes within the epoch.
    pub(crate) version: u64,
}

/// Changes asked for, by what came of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize)]
pub struct EditCounts {
    /// Made.
    pub made: u64,
    /// Refused; nothing was changed.
    pub refused: u64,
}

impl LeaderStatus {
    pub(crate) fn to_wire(&self, sent_at_ns: i64) -> v1::VehicleStatus {
        v1::VehicleStatus {
            vehicle: self.vehicle.clone(),
            role: self.role.to_owned(),
            version: self.version.to_owned(),
            uptime_s: self.uptime_s,
            sent_at_ns,
            set_epoch: self.set.epoch,
            set_version: self.set.version,
            landmark_count: u32::try_from(self.landmarks).unwrap_or(u32::MAX),
            cameras: Vec::new(),
            recorder: None,
            instance: self.instance.clone(),
            clocks: Vec::new(),
        }
    }
}
