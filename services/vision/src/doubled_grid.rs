//! The doubled grid of thesis 4.0.3 step 4, the one place that knows its factor of two.
//!
//! The thesis enlarges the picture twofold by nearest neighbour and slides its window over the result. Here the
//! enlarged picture never exists: sample (X, Y) of it is pixel (⌊X/2⌋, ⌊Y/2⌋) of the frame, so a window that starts at
//! X covers whole pixels twice and, where it begins or ends between two samples of one pixel, that pixel once. Mask
//! pixel (X, Y) stands for the window whose first sample is (X, Y); only windows that lie wholly inside the region
//! exist.

use std::ops::Range;

use crate::geometry::{PointPx, RectPx};
use crate::landmark::WindowPx;

/// Samples of the doubled grid along one pixel of the frame.
const SAMPLES_PER_PX: u32 = 2;

/// One window sliding over one region of a frame, on the doubled grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DoubledGrid {
    region: RectPx,
    window: WindowPx,
}

impl DoubledGrid {
    /// That window over that region; `None` where not a single window fits.
    #[must_use]
    pub fn new(region: RectPx, window: WindowPx) -> Option<Self> {
        let fits = |side_px: u32, window: u16| window > 0 && u32::from(window) <= SAMPLES_PER_PX * side_px;
        (fits(region.width, window.width) && fits(region.height, window.height))
            .then_some(Self { region, window })
    }

    /// The part of the frame that is searched.
    #[must_use]
    pub fn region(&self) -> RectPx {
        self.region
    }

    /// The window, in samples of the doubled grid.
    #[must_use]
    pub fn window(&self) -> WindowPx {
        self.window
    }

    /// Samples in a window, n.
    #[must_use]
    pub fn samples(&self) -> u32 {
        u32::from(self.window.width) * u32::from(self.window.height)
    }

    /// Columns of the mask: window positions along x.
    #[must_use]
    pub fn mask_width(&self) -> u32 {
        SAMPLES_PER_PX * self.region.width - u32::from(self.window.width) + 1
    }

    /// Rows of the mask: window positions along y.
    #[must_use]
    pub fn mask_height(&self) -> u32 {
        SAMPLES_PER_PX * self.region.height - u32::from(self.window.height) + 1
    }

    /// Where in the frame the centre of the window at mask pixel (`x`, `y`) lies. Fractions are welcome: the centroid
    /// of many mask pixels maps like a pixel.
    #[must_use]
    pub fn frame_from_mask(&self, x: f64, y: f64) -> PointPx {
        self.frame_from_sample(
            x + f64::from(self.window.width) / 2.0,
            y + f64::from(self.window.height) / 2.0,
        )
    }

    /// Where in the frame a point of the doubled grid lies; both have their origin at a corner.
    #[must_use]
    pub fn frame_from_sample(&self, x: f64, y: f64) -> PointPx {
        let scale = f64::from(SAMPLES_PER_PX);
        PointPx::new(
            (f64::from(self.region.x) + x / scale) as f32,
            (f64::from(self.region.y) + y / scale) as f32,
        )
    }

    /// The mask pixel, possibly outside the mask, of the window whose centre is nearest to `point`.
    #[must_use]
    pub fn mask_from_frame(&self, point: PointPx) -> (f64, f64) {
        let scale = f64::from(SAMPLES_PER_PX);
        (
            (f64::from(point.x) - f64::from(self.region.x)) * scale - f64::from(self.window.width) / 2.0,
            (f64::from(point.y) - f64::from(self.region.y)) * scale - f64::from(self.window.height) / 2.0,
        )
    }

    /// Frame pixels² of an area on the doubled grid.
    #[must_use]
    pub fn area_px2_from_samples(samples: f64) -> f64 {
        samples / f64::from(SAMPLES_PER_PX * SAMPLES_PER_PX)
    }

    /// Pixels (of the region, along one axis) under a window side of `side` samples that starts at sample `start`.
    #[must_use]
    pub fn pixels_under(start: u32, side: u16) -> Range<u32> {
        start / SAMPLES_PER_PX..(start + u32::from(side)).div_ceil(SAMPLES_PER_PX)
    }

    /// The most pixels that [`pixels_under`](Self::pixels_under) gives for any start.
    #[must_use]
    pub fn most_pixels_under(side: u16) -> u32 {
        u32::from(side) / SAMPLES_PER_PX + 1
    }

    /// How many of the `side` samples from `start` fall on pixel `at`: 0, 1 or 2.
    #[must_use]
    pub fn samples_on(at: u32, start: u32, side: u16) -> u32 {
        let end = (start + u32::from(side)).min(SAMPLES_PER_PX * (at + 1));
        end.saturating_sub(start.max(SAMPLES_PER_PX * at))
    }

    /// Of a window side of `side` samples: how many pixels in a row it covers twice wherever it starts. The first of
    /// them is [`first_whole_pixel`](Self::first_whole_pixel).
    #[must_use]
    pub fn whole_pixels(side: u16) -> u32 {
        (u32::from(side) - 1) / SAMPLES_PER_PX
    }

    /// Of a window side of `side` samples that starts on the first sample of a pixel: how many pixels it covers twice. (A
    /// window with an even side that starts on a second sample is the mean of the two beside it that do not.)
    #[must_use]
    pub fn aligned_pixels(side: u16) -> u32 {
        u32::from(side) / SAMPLES_PER_PX
    }

    /// The samples on pixel `pixel`, where windows may start.
    #[must_use]
    pub fn starts_on(pixel: u32) -> Range<u32> {
        SAMPLES_PER_PX * pixel..SAMPLES_PER_PX * (pixel + 1)
    }

    /// The pixels on which windows of these starts begin.
    #[must_use]
    pub fn pixels_of_starts(starts: &Range<u32>) -> Range<u32> {
        starts.start / SAMPLES_PER_PX..starts.end.div_ceil(SAMPLES_PER_PX)
    }

    /// The first pixel that a window starting at sample `start` covers twice.
    #[must_use]
    pub fn first_whole_pixel(start: u32) -> u32 {
        start.div_ceil(SAMPLES_PER_PX)
    }

    /// The starts whose [`first_whole_pixel`](Self::first_whole_pixel) lies within `pixels`.
    #[must_use]
    pub fn starts_with_first_whole_pixel(pixels: Range<u32>) -> Range<u32> {
        let start = |pixel: u32| (SAMPLES_PER_PX * pixel).saturating_sub(SAMPLES_PER_PX - 1);
        start(pixels.start)..start(pixels.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_sample_is_counted_once(start in 0u32..40, side in 1u16..40) {
            let counted: u32 = DoubledGrid::pixels_under(start, side)
                .map(|at| DoubledGrid::samples_on(at, start, side)).sum();
            prop_assert_eq!(counted, u32::from(side));
            prop_assert!(DoubledGrid::pixels_under(start, side).len() as u32 <= DoubledGrid::most_pixels_under(side));
        }

        #[test]
        fn whole_pixels_are_covered_twice(start in 0u32..40, side in 1u16..40) {
            let first = DoubledGrid::first_whole_pixel(start);
            for at in first..first + DoubledGrid::whole_pixels(side) {
                prop_assert_eq!(DoubledGrid::samples_on(at, start, side), 2);
            }
        }

        #[test]
        fn starts_are_the_inverse_of_first_whole_pixels(from in 0u32..20, count in 0u32..9, start in 0u32..80) {
            let pixels = from..from + count;
            let inside = pixels.contains(&DoubledGrid::first_whole_pixel(start));
            prop_assert_eq!(DoubledGrid::starts_with_first_whole_pixel(pixels).contains(&start), inside);
        }
    }

    #[test]
    fn a_window_of_two_samples_on_the_first_pixel_is_centred_on_it() {
        let region = RectPx { x: 3, y: 5, width: 4, height: 4 };
        let grid = DoubledGrid::new(region, WindowPx::square(2)).unwrap();
        assert_eq!(grid.frame_from_mask(0.0, 0.0), PointPx::new(3.5, 5.5));
        assert_eq!((grid.mask_width(), grid.mask_height()), (7, 7));
        assert_eq!(grid.mask_from_frame(PointPx::new(3.5, 5.5)), (0.0, 0.0));
    }

    #[test]
    fn a_window_larger_than_the_region_has_no_grid() {
        let region = RectPx { x: 0, y: 0, width: 3, height: 3 };
        assert_eq!(DoubledGrid::new(region, WindowPx::square(7)), None);
        assert_eq!(DoubledGrid::new(region, WindowPx { width: 0, height: 1 }), None);
        assert!(DoubledGrid::new(region, WindowPx::square(6)).is_some());
    }
}
