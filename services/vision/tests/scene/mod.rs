//! Small synthetic scenes: textured floor, blocks with cast shadows, look-alikes, occluders.
#![allow(clippy::unwrap_used, dead_code, reason = "shared by test files that use different parts of it")]

pub(crate) mod fine;
pub(crate) mod signs;

use std::sync::Arc;

use vision::{
    Frame, FrameStamp, Landmark, LandmarkOutcome, LandmarkSet, LearnOptions, Outcome, PointPx, RectPx,
    SetVersion, ShapeClass, Sighting, Timestamp, learn,
};

pub(crate) const WIDTH: u32 = 200;
pub(crate) const HEIGHT: u32 = 150;
pub(crate) const RED: [u8; 3] = [205, 60, 40];
pub(crate) const GREY: [u8; 3] = [120, 120, 125];

/// A rectangle of one colour with its top left corner at a sub-pixel place.
#[derive(Clone, Copy)]
pub(crate) struct Block {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) width: f32,
    pub(crate) height: f32,
    pub(crate) color: [u8; 3],
}

impl Block {
    pub(crate) fn square(x: f32, y: f32, side: f32, color: [u8; 3]) -> Self {
        Self { x, y, width: side, height: side, color }
    }

    pub(crate) fn centre(&self) -> PointPx {
        PointPx::new(self.x + self.width / 2.0, self.y + self.height / 2.0)
    }

    /// The part of the pixel at (`x`, `y`) that the block covers.
    fn share(&self, x: u32, y: u32) -> f32 {
        let overlap = |from: f32, length: f32, at: u32| {
            ((from + length).min(at as f32 + 1.0) - from.max(at as f32)).clamp(0.0, 1.0)
        };
        overlap(self.x, self.width, x) * overlap(self.y, self.height, y)
    }
}

/// A repeatable pseudo-random number for a place (a hash, not a generator).
fn noise(x: u32, y: u32, seed: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    ((h ^ (h >> 15)) & 0xFFFF) as f32 / 65535.0 - 0.5
}

/// Blocks on a textured blue floor, each with a shadow to its right, later ones in front, under a light of `gain`.
pub(crate) fn picture(blocks: &[Block], gain: f32, seed: u32) -> Frame {
    let mut rgb = Vec::with_capacity((3 * WIDTH * HEIGHT) as usize);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let texture = 10.0 * noise(x / 6, y / 4, 7);
            let mut color = [45.0 + texture, 95.0 + texture, 165.0 + texture];
            for block in blocks {
                let shadow =
                    Block { x: block.x + 0.3 * block.width, y: block.y + 0.7 * block.height, ..*block };
                let dark = 1.0 - 0.5 * shadow.share(x, y) * f32::from(u8::from(block.color != GREY));
                color = color.map(|level| level * dark);
            }
            for block in blocks {
                let share = block.share(x, y);
                for (level, own) in color.iter_mut().zip(block.color) {
                    *level += share * (f32::from(own) - *level);
                }
            }
            rgb.extend(color.map(|level| (gain * level + 6.0 * noise(x, y, seed)).clamp(0.0, 255.0) as u8));
        }
    }
    Frame::from_rgb(WIDTH, HEIGHT, rgb).unwrap()
}

/// What is learned of a red block of 24 px.
pub(crate) fn red_landmark() -> Landmark {
    let frame = picture(&[Block::square(80.0, 60.0, 24.0, RED)], 1.0, 1);
    let region = RectPx { x: 80, y: 60, width: 24, height: 24 };
    let options = LearnOptions { id: "red".into(), shape: ShapeClass::Block, ..LearnOptions::default() };
    learn(&[(&frame, region)], &options).unwrap()
}

pub(crate) fn set_of(landmarks: Vec<Landmark>) -> LandmarkSet {
    LandmarkSet { version: SetVersion::default(), landmarks: landmarks.into_iter().map(Arc::new).collect() }
}

pub(crate) fn stamp(k: u32) -> FrameStamp {
    FrameStamp {
        sequence: u64::from(k),
        captured_at: Timestamp::from_nanos(1_700_000_000_000_000_000 + i64::from(k) * 33_333_333),
    }
}

pub(crate) fn seen(outcome: &Outcome) -> Vec<(&LandmarkOutcome, &Sighting)> {
    outcome
        .landmarks
        .iter()
        .filter_map(|row| row.result.as_ref().ok().map(|sighting| (row, sighting)))
        .collect()
}
