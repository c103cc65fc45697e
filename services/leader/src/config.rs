//! What a leader is told at its start.

use std::path::PathBuf;

use http_face::HttpSettings;
use runtime::SessionSettings;
use runtime::telemetry::LogSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use waymark_proto::keys::{Id, VehicleKeys};

use crate::error::LeaderError;
use crate::landmark_files::read_landmarks;

/// One leader vehicle.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LeaderConfig {
    /// The fleet's id.
    pub fleet: String,
    /// This vehicle's id.
    pub vehicle: String,
    /// Landmark files, and directories of them (every `*.json`), published at the start. A landmark that was retired
    /// while the leader ran comes back at the next start as long as its file is listed here.
    pub landmarks: Vec<PathBuf>,
    /// Cameras of this vehicle that the page shows, so that landmarks can be learned by hand.
    pub cameras: Vec<String>,
    /// Where the start counter, the set as it was last, and the machine's id are kept.
    pub state_dir: PathBuf,
    /// The web face.
    pub http: HttpSettings,
    /// How the others are reached.
    pub zenoh: SessionSettings,
    /// What is logged on standard error.
    pub log: LogSettings,
}

impl LeaderConfig {
    /// Looks whether a leader could start with this, as far as that can be told without the network.
    ///
    /// # Errors
    /// As the leader's start.
    pub fn check(&self) -> Result<(), LeaderError> {
        VehicleKeys::new(&self.fleet, &self.vehicle)?;
        self.cameras.iter().try_for_each(|camera| Id::new("camera", camera).map(drop))?;
        self.http.policy()?;
        read_landmarks(&self.landmarks)?;
        Ok(())
    }
}

impl Default for LeaderConfig {
    fn default() -> Self {
        Self {
            fleet: "convoy".to_owned(),
            vehicle: "leader".to_owned(),
            landmarks: Vec::new(),
            cameras: Vec::new(),
            state_dir: PathBuf::from("state/leader"),
            http: HttpSettings::on_loopback(8081),
            zenoh: SessionSettings::default(),
            log: LogSettings::default(),
        }
    }
}
