//! Landmarks as JSON documents of the web face.

use serde_json::{Value, json};
use vision::{ColorStats, Landmark, LandmarkSet};

/// The whole set with its version.
pub(crate) fn set_document(set: &LandmarkSet) -> Value {
    json!({
        "version": { "epoch": set.version.epoch, "version": set.version.version },
        "landmarks": set.landmarks.iter().map(|landmark| landmark_document(landmark)).collect::<Vec<_>>(),
    })
}

/// One landmark.
pub(crate) fn landmark_document(landmark: &Landmark) -> Value {
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
