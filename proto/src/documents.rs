//! Landmarks as JSON documents of a web face: numbers as numbers, names as the command line writes them.
//!
//! Files and recordings use the protobuf's own JSON mapping instead ([`crate::json`]).

use serde_json::{Value, json};
use vision::{ColorStats, Landmark, LandmarkSet};

/// The whole set with its version.
#[must_use]
pub fn set_document(set: &LandmarkSet) -> Value {
    json!({
        "version": { "epoch": set.version.epoch, "version": set.version.version },
        "landmarks": set.landmarks.iter().map(|landmark| landmark_document(landmark)).collect::<Vec<_>>(),
    })
}

/// One landmark.
#[must_use]
pub fn landmark_document(landmark: &Landmark) -> Value {
    json!({
        "id": landmark.id,
        "revision": landmark.revision,
        "digest": landmark.digest.to_string(),
        "window_px": [landmark.window_px.width, landmark.window_px.height],
        "shape": landmark.shape.name(),
        "size_m": landmark.size_m,
        "tolerance": statistics(&landmark.tolerance),
        "shades": landmark.shades.iter().map(statistics).collect::<Vec<_>>(),
    })
}

fn statistics(stats: &ColorStats) -> Value {
    json!({ "mean": stats.mean, "variance": stats.variance })
}
