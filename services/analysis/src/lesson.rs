//! What a simulated leader teaches: landmarks learned from its own camera, in boxes as a person would draw them.

use simulator::{OptionsError, SceneKind, SceneOptions, Simulator, TrueObject};
use vision::learn::{LearnError, LearnOptions, learn};
use vision::{Frame, Landmark, RectPx, ShapeClass};
use waymark_proto::digest::landmark_digest;

/// The vehicle number of the leader among the scene's vehicles.
pub const LEADER: u32 = 0;
/// The vehicle number of the follower.
pub const FOLLOWER: u32 = 1;

/// Why nothing could be learned.
#[derive(Debug, thiserror::Error)]
pub enum LessonError {
    /// The scene cannot be simulated.
    #[error(transparent)]
    Scene(#[from] OptionsError),
    /// The leader does not see the object.
    #[error("`{id}` does not show in the leader's first pictures")]
    NotSeen {
        /// The landmark.
        id: String,
    },
    /// The leader sees too little of it.
    #[error("`{id}` is never larger than {width}×{height} pixels in the leader's first pictures")]
    TooSmall {
        /// The landmark.
        id: String,
        /// Of the best view.
        width: u32,
        /// Of the best view.
        height: u32,
    },
    /// The best view cannot be learned from.
    #[error(transparent)]
    Learn(#[from] LearnError),
}

/// Frames of the leader's drive that are looked through for a good view of each object.
const SURVEYED_FRAMES: std::ops::Range<u64> = 0..60;
/// A box smaller than this shows too little of an object to learn it.
const LEAST_SIDE_PX: u32 = 8;

/// What is learned in a scene: the landmark's id, the objects it stands for (all whose names begin so), its shape, and
/// its width in metres where all of them have the same.
const fn subjects(scene: SceneKind) -> &'static [(&'static str, ShapeClass, Option<f32>)] {
    match scene {
        SceneKind::Rink => &[("red", ShapeClass::Block, Some(0.1)), ("blue", ShapeClass::Block, Some(0.1))],
        SceneKind::StopSign => &[("sign", ShapeClass::Octagon, Some(0.75))],
        SceneKind::GreenSigns => &[("sign", ShapeClass::Rectangle, None)],
    }
}

/// An object of which less than this part can be seen in a picture is not learned from it: something may stand in front
/// of it in all of them.
const LEAST_VISIBLE: f64 = 0.9;

/// Learns every subject of the scene from the leader's own pictures.
///
/// # Errors
/// When the leader does not see enough of one of them.
pub fn learn_from(scene: SceneKind, seed: u64) -> Result<Vec<Landmark>, LessonError> {
    let options = SceneOptions { seed, vehicle: LEADER, ..SceneOptions::new(scene) };
    let mut simulator = Simulator::new(options)?;
    let views: Vec<(Frame, Vec<TrueObject>)> = SURVEYED_FRAMES
        .step_by(10)
        .map(|frame| {
            let rendered = simulator.render(frame);
            (rendered.frame, rendered.truth)
        })
        .collect();
    subjects(scene).iter().map(|&(id, shape, size_m)| landmark(id, shape, size_m, &views)).collect()
}

/// Learns one landmark from the picture in which its object is largest and hardly covered.
fn landmark(
    id: &str,
    shape: ShapeClass,
    size_m: Option<f32>,
    views: &[(Frame, Vec<TrueObject>)],
) -> Result<Landmark, LessonError> {
    let seen = views.iter().flat_map(|(frame, truth)| truth.iter().map(move |object| (frame, object)));
    let whole = seen.filter(|(_, object)| object.object.starts_with(id) && object.visible > LEAST_VISIBLE);
    let best = whole.max_by(|(_, a), (_, b)| a.area_px2.total_cmp(&b.area_px2));
    let (frame, object) = best.ok_or_else(|| LessonError::NotSeen { id: id.to_owned() })?;
    let region = box_around(object);
    if region.width.min(region.height) < LEAST_SIDE_PX {
        let RectPx { width, height, .. } = region;
        return Err(LessonError::TooSmall { id: id.to_owned(), width, height });
    }
    let options = LearnOptions { id: id.to_owned(), shape, size_m, ..LearnOptions::default() };
    let learned = learn(&[(frame, region)], &options)?;
    Ok(Landmark { digest: landmark_digest(&learned), ..learned })
}

fn box_around(object: &TrueObject) -> RectPx {
    let [left, top, right, bottom] = object.bbox_px;
    let (x, y) = (left.floor().max(0.0) as u32, top.floor().max(0.0) as u32);
    RectPx { x, y, width: right.floor() as u32 - x, height: bottom.floor() as u32 - y }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_can_be_taught() {
        for scene in [SceneKind::Rink, SceneKind::StopSign, SceneKind::GreenSigns] {
            let landmarks = learn_from(scene, 1).unwrap_or_else(|error| panic!("{scene}: {error}"));
            assert_eq!(landmarks.len(), subjects(scene).len());
        }
    }
}
