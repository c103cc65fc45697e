//! What a follower is told at its start.

use std::collections::BTreeMap;
use std::path::PathBuf;

use http_face::HttpSettings;
use runtime::SessionSettings;
use runtime::telemetry::LogSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vision::follow::{FollowOptions, Mode};
use vision::predict::PredictionMethod;
use waymark_proto::keys::{Id, VehicleKeys};

use crate::error::FollowerError;

/// One follower vehicle.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FollowerConfig {
    /// The fleet's id.
    pub fleet: String,
    /// This vehicle's id.
    pub vehicle: String,
    /// The vehicle whose landmarks are followed.
    pub leader: String,
    /// The cameras of this vehicle that are looked through.
    pub cameras: Vec<String>,
    /// `faithful` or `adaptive`.
    pub mode: ModeName,
    /// `persistence`, `constant-velocity` or `kalman`.
    pub prediction: PredictionName,
    /// Where the accepted landmark set and the machine's id are kept.
    pub state_dir: PathBuf,
    /// The web face.
    pub http: HttpSettings,
    /// The recorder.
    pub recorder: RecorderConfig,
    /// How the others are reached.
    pub zenoh: SessionSettings,
    /// What is logged on standard error.
    pub log: LogSettings,
}

/// The recorder of a vehicle.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RecorderConfig {
    /// Whether to record from the start.
    pub enabled: bool,
    /// Where recordings go.
    pub directory: PathBuf,
    /// A new file is begun beyond this size.
    pub max_file_bytes: u64,
    /// A new file is begun after this time.
    pub max_file_s: u64,
    /// All recordings of this vehicle together; beyond it the oldest are deleted. 0 deletes nothing.
    pub max_total_bytes: u64,
    /// Left free on the disk: the oldest recordings make room where `max_total_bytes` is set, else recording stops.
    pub min_free_bytes: u64,
    /// So many seconds before recording is started are recorded too. 0 keeps none.
    pub pre_trigger_s: u64,
    /// Memory those seconds may take; beyond it the oldest are given up.
    pub pre_trigger_max_bytes: usize,
    /// Whether every registered picture is recorded a second time with what was seen drawn into it, for viewers that do
    /// not show annotations.
    pub burned_in: bool,
}

/// Names of the registration modes.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModeName {
    /// The thesis's method with fixed statistics.
    Faithful,
    /// With everything that real cameras need.
    #[default]
    Adaptive,
}

/// Names of the predictors that can drive a gate.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PredictionName {
    /// Where it was.
    Persistence,
    /// Equation 4.1 with the sign it was meant to have.
    ConstantVelocity,
    /// Position, velocity, log area and its rate.
    #[default]
    Kalman,
}

impl Default for FollowerConfig {
    fn default() -> Self {
        Self {
            fleet: "convoy".to_owned(),
            vehicle: "follower".to_owned(),
            leader: "leader".to_owned(),
            cameras: vec!["front".to_owned()],
            mode: ModeName::default(),
            prediction: PredictionName::default(),
            state_dir: PathBuf::from("state/follower"),
            http: HttpSettings::on_loopback(8080),
            recorder: RecorderConfig::default(),
            zenoh: SessionSettings::default(),
            log: LogSettings::default(),
        }
    }
}

impl Default for RecorderConfig {
    fn default() -> Self {
        Self {
            enabled: true,
            directory: PathBuf::from("recordings"),
            max_file_bytes: 4 << 30,
            max_file_s: 3600,
            max_total_bytes: 0,
            min_free_bytes: 1 << 30,
            pre_trigger_s: 0,
            pre_trigger_max_bytes: 48 << 20,
            burned_in: false,
        }
    }
}

impl FollowerConfig {
    /// Looks whether a follower could start with this, as far as that can be told without the network.
    ///
    /// # Errors
    /// As the follower's start.
    pub fn check(&self) -> Result<(), FollowerError> {
        VehicleKeys::new(&self.fleet, &self.vehicle)?;
        VehicleKeys::new(&self.fleet, &self.leader)?;
        self.cameras.iter().try_for_each(|camera| Id::new("camera", camera).map(drop))?;
        self.http.policy()?;
        Ok(())
    }

    /// The configuration as a recording keeps it: nothing in it is secret, since the token stands in a file of its own.
    pub(crate) fn as_metadata(&self) -> BTreeMap<String, String> {
        let value = serde_json::to_value(self).unwrap_or_default();
        let members = value.as_object().into_iter().flatten();
        members.map(|(name, value)| (name.clone(), value.to_string())).collect()
    }

    /// What the state machine of each camera is told.
    #[must_use]
    pub fn follow_options(&self) -> FollowOptions {
        FollowOptions {
            mode: match self.mode {
                ModeName::Faithful => Mode::Faithful,
                ModeName::Adaptive => Mode::Adaptive,
            },
            prediction: match self.prediction {
                PredictionName::Persistence => PredictionMethod::Persistence,
                PredictionName::ConstantVelocity => PredictionMethod::ConstantVelocity,
                PredictionName::Kalman => PredictionMethod::Kalman,
            },
            ..FollowOptions::default()
        }
    }
}
