//! What a leader is told at its start.

use std::net::SocketAddr;
use std::path::PathBuf;

use runtime::SessionSettings;
use runtime::telemetry::LogSettings;
use serde::{Deserialize, Serialize};

/// One leader vehicle.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct LeaderConfig {
    /// The fleet's id.
    pub fleet: String,
    /// This vehicle's id.
    pub vehicle: String,
    /// Landmark files, and directories of them (every `*.json`), published at the start. A landmark that was retired
    /// while the leader ran comes back at the next start as long as its file is listed here.
    pub landmarks: Vec<PathBuf>,
    /// Where the start counter, the set as it was last, and the machine's id are kept.
    pub state_dir: PathBuf,
    /// The web face.
    pub http: LeaderHttpConfig,
    /// How the others are reached.
    pub zenoh: SessionSettings,
    /// What is logged on standard error.
    pub log: LogSettings,
}

/// The web face of a leader.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct LeaderHttpConfig {
    /// Address and port; beyond loopback it is read-only without a token.
    pub listen: SocketAddr,
    /// File that holds the bearer token for changes.
    pub token_file: Option<PathBuf>,
    /// Host names that are accepted besides IP addresses, localhost and the machine's name.
    pub hosts: Vec<String>,
}

impl Default for LeaderConfig {
    fn default() -> Self {
        Self {
            fleet: "convoy".to_owned(),
            vehicle: "leader".to_owned(),
            landmarks: Vec::new(),
            state_dir: PathBuf::from("state/leader"),
            http: LeaderHttpConfig::default(),
            zenoh: SessionSettings::default(),
            log: LogSettings::default(),
        }
    }
}

impl Default for LeaderHttpConfig {
    fn default() -> Self {
        Self { listen: SocketAddr::from(([127, 0, 0, 1], 8081)), token_file: None, hosts: Vec::new() }
    }
}
