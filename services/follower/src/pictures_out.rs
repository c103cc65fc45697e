//! Pictures for whoever looks: a frame, with or without what was seen in it.

use std::sync::Arc;

use http_face::{Depiction, PictureRequest};
use ingest::camera_thread::{self, Registered};
use ingest::view;
use tokio::sync::watch;
use vision::overlay::{self, Layers, UnknownLayer, adapted};
use vision::{Frame, Landmark, LandmarkOutcome, LandmarkSet, Outcome, Place};

use crate::seen_frame::SeenFrame;

/// Names of what can be drawn over a frame.
pub(crate) const LAYERS: &[&str] = &["mask", "outline", "segments", "vector", "prediction", "gate", "labels"];

/// Drawn before all others, from the pixels themselves.
const MASK: &str = "mask";

/// The landmarks in force; a mask is only drawn of a descriptor that is still the one that was looked for.
pub(crate) type Landmarks = watch::Receiver<Arc<LandmarkSet>>;

/// A registered frame, and where the landmarks in it are.
#[derive(Debug)]
pub(crate) struct Shown {
    pub(crate) registered: Arc<Registered>,
    pub(crate) places: Vec<Place>,
}

/// How registered frames are shown, and told to whoever draws by himself.
pub(crate) fn depiction(landmarks: Landmarks) -> Depiction<Shown> {
    Depiction {
        render: Arc::new(move |Shown { registered, .. }: &Shown, request: &PictureRequest| {
            let frame = camera_thread::decode(&registered.picture).map_err(|error| error.to_string())?;
            let set = Arc::clone(&landmarks.borrow());
            drawn(frame, &registered.outcome, request, &set.landmarks)
        }),
        own_jpeg: |shown| shown.registered.picture.own_jpeg(),
        told: Some(Arc::new(|Shown { registered, places }: &Shown| {
            serde_json::to_string(&SeenFrame::new(&registered.outcome, places))
        })),
    }
}

/// A frame with what was seen in it, as a viewer asked for it; live and recorded pictures are drawn alike. `landmarks`
/// are those that may have been looked for.
pub(crate) fn drawn(
    mut frame: Frame,
    outcome: &Outcome,
    request: &PictureRequest,
    landmarks: &[Arc<Landmark>],
) -> Result<Vec<u8>, String> {
    let mut names = request.layers.clone().unwrap_or_default();
    if names.contains(&MASK) {
        overlay::tint(&mut frame, &looked_for(landmarks, outcome));
    }
    names.retain(|name| *name != MASK);
    if !names.is_empty() {
        let layers: Layers = names.join(",").parse().map_err(|error: UnknownLayer| error.to_string())?;
        overlay::draw(&mut frame, outcome, layers);
    }
    view::encoded(frame, request)
}

/// The descriptors as they were compared with this frame: in its light, at the scale of each object.
fn looked_for(landmarks: &[Arc<Landmark>], outcome: &Outcome) -> Vec<Landmark> {
    let of_one = |one: &LandmarkOutcome| {
        let landmark = landmarks.iter().find(|landmark| landmark.digest == one.digest)?;
        Some(one.adaptation.as_ref().map_or_else(|| landmark.as_ref().clone(), |how| adapted(landmark, how)))
    };
    outcome.landmarks.iter().filter(|one| one.instance == 0).filter_map(of_one).collect()
}
