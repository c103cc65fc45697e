//! `/api/v1/status` as people and programs read it (contract section 8). Missing values are `null`, never 0.

use runtime::clock::ClockOffset;
use schemars::JsonSchema;
use serde::Serialize;
use vision::outcome::{LandmarkOutcome, Miss};
use vision::{ColorStats, Outcome, Place};

/// What one vehicle says of itself.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct VehicleStatus {
    /// The vehicle's id.
    pub vehicle: String,
    /// Always `follower` here.
    pub role: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// Seconds since the start.
    pub uptime_s: f64,
    /// The vehicle that is followed.
    pub leader: LeaderStatus,
    /// The way to the others.
    pub router: RouterStatus,
    /// Landmarks in force.
    pub landmarks: usize,
    /// Every camera that was ever heard, by id.
    pub cameras: Vec<CameraStatus>,
    /// The recorder.
    pub recorder: RecorderStatus,
}

/// The leader as this follower knows it.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct LeaderStatus {
    /// The followed vehicle's id.
    pub vehicle: String,
    /// Whether its liveliness token is there, and it was heard within a lease.
    pub present: bool,
    /// Seconds since it was last heard.
    pub age_s: Option<f64>,
    /// Manifests that it sent and that did not arrive, by the gaps in their sequence.
    pub missed: Option<u64>,
    /// How far its clock is off, as measured within the last seconds.
    pub clock: Option<ClockStatus>,
}

/// How far another machine's clock is off.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
pub struct ClockStatus {
    /// The other clock minus this machine's, ms.
    pub offset_ms: f64,
    /// How far that may be wrong either way, ms.
    pub uncertainty_ms: f64,
    /// Whether the clocks agree to within a frame at 30 Hz, as far as that is certain.
    pub in_step: bool,
}

impl From<ClockOffset> for ClockStatus {
    fn from(clock: ClockOffset) -> Self {
        Self {
            offset_ms: clock.offset_ns as f64 * 1e-6,
            uncertainty_ms: clock.uncertainty_ns() as f64 * 1e-6,
            in_step: clock.is_in_step(),
        }
    }
}

/// Everyone who is announced in the fleet, as `/api/v1/fleet` tells it.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct FleetStatus {
    /// By vehicle, role and instance.
    pub members: Vec<FleetMember>,
}

/// A process of the fleet.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize)]
pub struct FleetMember {
    /// Its vehicle's id.
    pub vehicle: String,
    /// What it does for the vehicle.
    pub role: &'static str,
    /// Names the process.
    pub instance: String,
    /// Whether it answered when asked last; one that is stopped is announced and does not.
    pub answers: bool,
    /// Name of its machine.
    pub host: Option<String>,
    /// Version of its program.
    pub version: Option<String>,
    /// How far its clock is off.
    pub clock: Option<ClockStatus>,
}

/// The way to the others.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub struct RouterStatus {
    /// Whether at least one router is connected; where this vehicle is itself a peer, a router or another peer.
    pub connected: bool,
}

/// One camera.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct CameraStatus {
    /// The camera's id.
    pub id: String,
    /// `waiting`, `live` or `stale`.
    pub state: &'static str,
    /// Number of the newest registered frame.
    pub sequence: Option<u64>,
    /// Age of the newest frame since its arrival, ms.
    pub age_ms: Option<f64>,
    /// Registered frames per second over the last seconds.
    pub fps: f64,
    /// Milliseconds from capture to result, of the newest frame.
    pub latency_ms: Option<f64>,
    /// Wall time of decoding and registering the newest frame, ms.
    pub processing_ms: Option<f64>,
    /// Frames that did not make it, by reason.
    pub dropped: Dropped,
    /// What the newest frame said.
    pub landmarks: Vec<LandmarkStatus>,
}

/// Frames that did not make it, by reason.
#[derive(Clone, Copy, Debug, Default, JsonSchema, Serialize)]
pub struct Dropped {
    /// Lost on the way here, by the gaps in their sequence.
    pub missed: u64,
    /// Video that arrived faster than it can be decoded.
    pub overrun: u64,
    /// Video that needs pictures which are missing, until the next keyframe.
    pub awaiting_keyframe: u64,
    /// Replaced in the mailbox by a newer one.
    pub replaced: u64,
    /// Damaged or of an unknown format.
    pub undecodable: u64,
    /// Refused before decoding: too large, or not a picture message.
    pub refused: u64,
    /// Registered, but the result found no room on its way to journal and publishers.
    pub unread: u64,
}

impl Dropped {
    /// Each reason with its count.
    #[must_use]
    pub fn by_reason(&self) -> [(&'static str, u64); 7] {
        [
            ("missed", self.missed),
            ("overrun", self.overrun),
            ("awaiting_keyframe", self.awaiting_keyframe),
            ("replaced", self.replaced),
            ("undecodable", self.undecodable),
            ("refused", self.refused),
            ("unread", self.unread),
        ]
    }
}

/// One instance of one landmark in the newest frame.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct LandmarkStatus {
    /// The landmark's id.
    pub id: String,
    /// Which of several objects.
    pub instance: u32,
    /// `measured`, or the miss's name.
    pub result: &'static str,
    /// Centre, frame pixels.
    pub x_px: Option<f32>,
    /// Centre, frame pixels.
    pub y_px: Option<f32>,
    /// Area, frame pixels².
    pub area_px2: Option<f32>,
    /// Belief, 0..1.
    pub score: Option<f32>,
    /// Fit of the shape, 0..1; missing when too small to tell.
    pub shape_score: Option<f32>,
    /// Distance of the measurement from its prediction.
    pub innovation_px: Option<f32>,
    /// Direction, rad, positive to the left of the optical axis; missing without a calibration.
    pub bearing_rad: Option<f32>,
    /// Distance, m; missing also where the object's size is unknown.
    pub range_m: Option<f32>,
    /// Observed brightness over the descriptor's.
    pub gain: Option<f32>,
    /// White added to the descriptor's colours before the gain, levels.
    pub haze: Option<f32>,
    /// Factor on the descriptor's mean tolerances under this light.
    pub tolerance_scale: Option<f32>,
    /// Noise variance of this camera, taken out of the observed variance, levels², R, G, B.
    pub noise_variance: Option<[f32; 3]>,
    /// Expected centre before the measurement.
    pub predicted_x_px: Option<f32>,
    /// Expected centre before the measurement.
    pub predicted_y_px: Option<f32>,
    /// The six statistics at the best window.
    pub observed: Option<Statistics>,
    /// Why it was missed, with the figures of the reason.
    pub miss: Option<MissStatus>,
}

/// Six statistics, R, G, B.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub struct Statistics {
    /// Means, levels.
    pub mean: [f32; 3],
    /// Population variances, levels².
    pub variance: [f32; 3],
}

/// Why a landmark was missed.
#[derive(Clone, Debug, Default, JsonSchema, Serialize)]
pub struct MissStatus {
    /// The miss's name.
    pub reason: &'static str,
    /// The best fit of the shape, 0..1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape_score: Option<f32>,
    /// Distance of the nearest candidate from the prediction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub innovation_px: Option<f32>,
    /// By how many tolerances the worst statistic of the nearest window was off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excess: Option<f32>,
    /// The six statistics of that nearest window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observed: Option<Statistics>,
    /// Part of the object that is still seen, 0..1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub visible: Option<f32>,
}

/// The recorder.
#[derive(Clone, Debug, Default, JsonSchema, Serialize)]
pub struct RecorderStatus {
    /// `off`, `recording` or `failed`.
    pub state: &'static str,
    /// The file being written.
    pub file: Option<String>,
    /// Bytes in it.
    pub bytes: u64,
    /// Messages offered and not stored since the start.
    pub lost: u64,
    /// Free bytes on its disk.
    pub free_bytes: Option<u64>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl From<recording::Status> for RecorderStatus {
    fn from(status: recording::Status) -> Self {
        Self {
            state: match status.state {
                recording::State::Off => "off",
                recording::State::Recording => "recording",
                recording::State::Failed => "failed",
            },
            file: status.file.map(|file| file.display().to_string()),
            bytes: status.bytes,
            lost: status.lost,
            free_bytes: status.free_bytes,
            reason: status.reason,
        }
    }
}

/// What one frame said about every landmark, for status and events; `places` as far as they are known, in the same order.
#[must_use]
pub fn landmarks_from_outcome(outcome: &Outcome, places: &[Place]) -> Vec<LandmarkStatus> {
    let places = places.iter().copied().chain(std::iter::repeat(Place::default()));
    outcome.landmarks.iter().zip(places).map(|(one, place)| landmark_from_outcome(one, place)).collect()
}

pub(crate) fn landmark_from_outcome(outcome: &LandmarkOutcome, place: Place) -> LandmarkStatus {
    let sighting = outcome.result.as_ref().ok();
    let miss = outcome.result.as_ref().err();
    let prediction = outcome.prediction;
    LandmarkStatus {
        id: outcome.landmark.clone(),
        instance: outcome.instance,
        result: miss.map_or("measured", Miss::name),
        x_px: sighting.map(|sighting| sighting.centroid.x),
        y_px: sighting.map(|sighting| sighting.centroid.y),
        area_px2: sighting.map(|sighting| sighting.area_px2),
        score: sighting.map(|sighting| sighting.score),
        shape_score: sighting.and_then(|sighting| sighting.shape_score),
        innovation_px: outcome.innovation_px,
        bearing_rad: place.bearing_rad,
        range_m: place.range_m,
        gain: outcome.adaptation.map(|adaptation| adaptation.gain),
        haze: outcome.adaptation.map(|adaptation| adaptation.haze),
        tolerance_scale: outcome.adaptation.map(|adaptation| adaptation.tolerance_scale),
        noise_variance: outcome.adaptation.map(|adaptation| adaptation.noise_variance),
        predicted_x_px: prediction.map(|prediction| prediction.centroid.x),
        predicted_y_px: prediction.map(|prediction| prediction.centroid.y),
        observed: sighting.map(|sighting| Statistics::from(sighting.observed)),
        miss: miss.map(MissStatus::from),
    }
}

impl From<ColorStats> for Statistics {
    fn from(stats: ColorStats) -> Self {
        Self { mean: stats.mean, variance: stats.variance }
    }
}

impl From<&Miss> for MissStatus {
    fn from(miss: &Miss) -> Self {
        let named = Self { reason: miss.name(), ..Self::default() };
        match *miss {
            Miss::NoColour { best } => Self {
                excess: best.map(|best| best.excess),
                observed: best.map(|best| best.observed.into()),
                ..named
            },
            Miss::WrongShape { score } => Self { shape_score: Some(score), ..named },
            Miss::OutsideGate { innovation_px } => Self { innovation_px: Some(innovation_px), ..named },
            Miss::Occluded { visible } => Self { visible: Some(visible), ..named },
            Miss::OutsideFrame | Miss::TooSmall | Miss::Skipped => named,
        }
    }
}
