//! Pictures for whoever looks: a frame, with or without what was seen in it.

use std::sync::Arc;

use http_face::{PictureRequest, Render};
use ingest::camera_thread::{self, Registered};
use ingest::view;
use tokio::sync::watch;
use vision::overlay::{self, Layers, UnknownLayer, adapted};
use vision::{Frame, Landmark, LandmarkOutcome, LandmarkSet, Outcome};

/// Names of what can be drawn over a frame.
pub(crate) const LAYERS: &[&str] = &["mask", "outline", "segments", "vector", "prediction", "gate", "labels"];

/// Drawn before all others, from the pixels themselves.
const MASK: &str = "mask";

/// The landmarks in force; a mask is only drawn of a descriptor that is still the one that was looked for.
pub(crate) type Landmarks = watch::Receiver<Arc<LandmarkSet>>;

/// Draws a view of a registered frame.
pub(crate) fn renderer(landmarks: Landmarks) -> Arc<Render<Registered>> {
    Arc::new(move |registered, request| {
        let frame = camera_thread::decode(&registered.picture).map_err(|error| error.to_string())?;
        drawn(frame, &registered.outcome, request, &landmarks)
    })
}

/// A frame with what was seen in it, as a viewer asked for it; live and recorded pictures are drawn alike.
pub(crate) fn drawn(
    mut frame: Frame,
    outcome: &Outcome,
    request: &PictureRequest,
    landmarks: &Landmarks,
) -> Result<Vec<u8>, String> {
    let mut names = request.layers.clone().unwrap_or_default();
    if names.contains(&MASK) {
        let set = Arc::clone(&landmarks.borrow());
        overlay::tint(&mut frame, &looked_for(&set, outcome));
    }
    names.retain(|name| *name != MASK);
    if !names.is_empty() {
        let layers: Layers = names.join(",").parse().map_err(|error: UnknownLayer| error.to_string())?;
        overlay::draw(&mut frame, outcome, layers);
    }
    view::encoded(frame, request)
}

/// The descriptors as they were compared with this frame: in its light, at the scale of each object.
fn looked_for(set: &LandmarkSet, outcome: &Outcome) -> Vec<Landmark> {
    let in_force =
        |one: &LandmarkOutcome| set.landmarks.iter().find(|landmark| landmark.digest == one.digest);
    let of_one = |one: &LandmarkOutcome| {
        let landmark = in_force(one)?;
        Some(one.adaptation.as_ref().map_or_else(|| landmark.as_ref().clone(), |how| adapted(landmark, how)))
    };
    outcome.landmarks.iter().filter(|one| one.instance == 0).filter_map(of_one).collect()
}
