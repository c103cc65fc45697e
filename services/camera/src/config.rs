//! What a camera is told at its start.

use runtime::SessionSettings;
use runtime::telemetry::LogSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use waymark_proto::keys::{Id, VehicleKeys};

use crate::coder::Coder;
use crate::error::CameraError;
use crate::run::period;
use crate::shots::Shots;

/// One camera of one vehicle.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CameraConfig {
    /// The fleet's id.
    pub fleet: String,
    /// The vehicle that carries the camera.
    pub vehicle: String,
    /// The camera's id.
    pub camera: String,
    /// Where pictures come from: a directory or glob, a film (`FILE.mp4`), `mcap:FILE#topic`, or `sim:SCENE?seed=N`.
    pub source: String,
    /// Pictures per second, for sources that do not bring their own times, within 0.01..=240.
    pub frame_rate_hz: f64,
    /// How pictures are sent.
    pub encoding: SentEncoding,
    /// JPEG quality of rendered pictures and of films, 1..=100.
    pub jpeg_quality: u8,
    /// How video is encoded, where pictures are sent as `h264`.
    pub h264: H264Config,
    /// What happens at the end of a directory or recording.
    pub at_end: AtEnd,
    /// How the others are reached.
    pub zenoh: SessionSettings,
    /// What is logged on standard error.
    pub log: LogSettings,
}

/// How pictures are sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SentEncoding {
    /// Each by itself: rendered pictures and films as JPEG, files and recordings as they are.
    #[default]
    Jpeg,
    /// As video, `foxglove.CompressedVideo`: a fraction of the bytes, but pictures need those before them.
    H264,
}

/// How video is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct H264Config {
    /// Step of quantisation, 1..=51; six more halve the quality. Every picture has the same.
    pub quantizer: u8,
    /// A picture that needs no other comes after that many, 1..=600: what a receiver that missed one waits for.
    pub keyframe_interval: u32,
}

impl Default for H264Config {
    fn default() -> Self {
        Self { quantizer: 24, keyframe_interval: 30 }
    }
}

/// What happens at the end of a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AtEnd {
    /// The camera ends.
    #[default]
    Stop,
    /// It begins again, with new times.
    Repeat,
}

impl CameraConfig {
    /// Looks whether a camera could start with this, as far as that can be told without the network.
    ///
    /// # Errors
    /// As the camera's start.
    pub fn check(&self) -> Result<(), CameraError> {
        VehicleKeys::new(&self.fleet, &self.vehicle)?;
        Id::new("camera", &self.camera)?;
        let _would_encode = Coder::new(self)?;
        period(Shots::open(self)?.frame_rate_hz().unwrap_or(self.frame_rate_hz))?;
        Ok(())
    }
}

impl Default for CameraConfig {
    fn default() -> Self {
        Self {
            fleet: "convoy".to_owned(),
            vehicle: "follower".to_owned(),
            camera: "front".to_owned(),
            source: "sim:rink?seed=1".to_owned(),
            frame_rate_hz: 30.0,
            encoding: SentEncoding::default(),
            jpeg_quality: 90,
            h264: H264Config::default(),
            at_end: AtEnd::default(),
            zenoh: SessionSettings::default(),
            log: LogSettings::default(),
        }
    }
}
