//! A simulated drive as a camera would send it, with its truth.

use simulator::{SceneKind, SceneOptions, Simulator, TrueObject};
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::{Frame, RectPx, Timestamp};
use waymark_proto::v1;

use super::ExperimentError;
use crate::score::Claim;
use crate::truth::{TrueObject as Meant, meant_object};

/// JPEG pictures and what they really show; frames count from 1.
pub(super) struct SimulatedDrive {
    pub(super) scene: SceneKind,
    frames: Vec<DrivenFrame>,
}

struct DrivenFrame {
    jpeg: Vec<u8>,
    captured_at: Timestamp,
    objects: Vec<TrueObject>,
}

impl SimulatedDrive {
    /// The first `frames` of a scene.
    pub(super) fn of(options: SceneOptions, frames: u64) -> Result<Self, ExperimentError> {
        let mut simulator = Simulator::new(options)?;
        let driven = (0..frames).map(|index| {
            let rendered = simulator.render(index);
            Ok(DrivenFrame {
                jpeg: encode_jpeg(&rendered.frame, Quality::default())?,
                captured_at: Timestamp::from_nanos(rendered.captured_offset_ns),
                objects: rendered.truth,
            })
        });
        Ok(Self { scene: options.kind, frames: driven.collect::<Result<_, ExperimentError>>()? })
    }

    /// How many frames there are.
    pub(super) fn len(&self) -> usize {
        self.frames.len()
    }

    /// The numbers of all frames.
    pub(super) fn numbers(&self) -> std::ops::RangeInclusive<usize> {
        1..=self.frames.len()
    }

    /// A frame as it arrives.
    pub(super) fn frame(&self, number: usize) -> Result<Frame, ExperimentError> {
        Ok(decode(&self.frames[number - 1].jpeg, &DecodeLimits::default())?)
    }

    pub(super) fn captured_at(&self, number: usize) -> Timestamp {
        self.frames[number - 1].captured_at
    }

    /// Everything with a name that a frame shows.
    pub(super) fn objects(&self, number: usize) -> &[TrueObject] {
        &self.frames[number - 1].objects
    }

    /// One object in a frame.
    pub(super) fn object(&self, number: usize, name: &str) -> Result<&TrueObject, ExperimentError> {
        let object = self.objects(number).iter().find(|object| object.object == name);
        object.ok_or_else(|| ExperimentError::NotShown {
            scene: self.scene.to_string(),
            frame: number,
            object: name.to_owned(),
        })
    }

    /// What a landmark stands for in a frame, by its claims where there are several.
    pub(super) fn meant(&self, number: usize, landmark: &str, claims: &[Claim]) -> Meant {
        let objects = self.objects(number).iter().map(Into::into).collect();
        meant_object(&v1::Truth { objects, ..v1::Truth::default() }, landmark, claims)
    }

    /// The middle of an object's bounding box, `part` of its width and height, in whole pixels.
    pub(super) fn region(&self, number: usize, name: &str, part: f64) -> Result<RectPx, ExperimentError> {
        let [left, top, right, bottom] = self.object(number, name)?.bbox_px;
        let span = |from: f64, to: f64| {
            let (middle, half) = ((from + to) / 2.0, part * (to - from) / 2.0);
            let start = (middle - half).ceil().max(0.0) as u32;
            (start, ((middle + half).floor() as u32).saturating_sub(start).max(1))
        };
        let ((x, width), (y, height)) = (span(left, right), span(top, bottom));
        Ok(RectPx { x, y, width, height })
    }
}
