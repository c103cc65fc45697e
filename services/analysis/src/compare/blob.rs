//! The plain colour filter: pixels near the landmark's mean colour, and their largest blob. What the thesis's reference
//! [7] follows an astronaut with.

use vision::{BitMask, ColorStats, Components, Frame, Landmark};

use crate::score::Claim;

/// Blobs of fewer pixels are noise.
const LEAST_PIXELS: u64 = 6;

/// The colours that count, with memory.
pub(super) struct ColourBlob {
    /// Least and greatest level of each channel, for each shade.
    ranges: Vec<[(f32, f32); 3]>,
    mask: BitMask,
    components: Components,
}

impl ColourBlob {
    pub(super) fn new(landmark: &Landmark) -> Self {
        let range = |shade: &ColorStats| {
            std::array::from_fn(|channel| {
                // A single pixel varies by the object's own spread as well.
                let reach = landmark.tolerance.mean[channel] + shade.variance[channel].sqrt();
                (shade.mean[channel] - reach, shade.mean[channel] + reach)
            })
        };
        let ranges = landmark.shades.iter().map(range).collect();
        Self { ranges, mask: BitMask::default(), components: Components::default() }
    }

    pub(super) fn look(&mut self, frame: &Frame) -> Option<Claim> {
        self.mask.reset(frame.width(), frame.height());
        for y in 0..frame.height() {
            for (x, pixel) in (0..).zip(frame.row(y).chunks_exact(3)) {
                let matches = |range: &[(f32, f32); 3]| {
                    range
                        .iter()
                        .zip(pixel)
                        .all(|(&(least, most), &level)| (least..=most).contains(&f32::from(level)))
                };
                if self.ranges.iter().any(matches) {
                    self.mask.set(x, y);
                }
            }
        }
        self.components.find(&self.mask);
        let largest = self.components.list().iter().max_by_key(|component| component.pixels)?;
        if largest.pixels < LEAST_PIXELS {
            return None;
        }
        let (x, y) = largest.mean_pixel();
        let centre = vision::PointPx::new(x as f32 + 0.5, y as f32 + 0.5);
        Some(Claim { centre, area_px2: largest.pixels as f32, score: 1.0 })
    }
}
