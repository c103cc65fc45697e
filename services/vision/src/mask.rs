//! Steps 4–9 of thesis 4.0.3: the mask of all window positions that match in all six parameters.
//!
//! The result equals, bit for bit, what the definition gives: enlarge the picture twofold, take the six statistics of
//! every window that lies wholly inside, compare ([`reference`](crate::reference)). Masks of several shades are
//! united.

mod chunk;
mod exact;
mod lane;
mod lanes;
mod planes;
mod powers;
mod sieve;

pub use lanes::Lanes;

use crate::bitmask::BitMask;
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::landmark::Landmark;
use crate::probe::{Stage, StageProbe};
use crate::statistics::Acceptance;

use exact::{Area, BLOCK_PX, Question, Scratch};
use lane::{MEDIUM_SAMPLES, Medium, NARROW_SAMPLES, Narrow, Wide};
use sieve::{Levels, Mesh, Sieve};

/// Above this share of blocks that may match, one pass over the whole region is cheaper than many small areas.
const DENSE_SHARE: f64 = 0.5;

/// Blocks tested side by side: the running sums of so many stay in the first-level cache.
const STRIP_BLOCKS: u32 = 8;

/// Finds masks; keeps its memory from one to the next.
#[derive(Default)]
pub struct Masker {
    lanes: Lanes,
    accepted: Vec<Acceptance>,
    levels: Vec<Levels>,
    sieve: Sieve,
    areas: Vec<Area>,
    narrow: Scratch<Narrow>,
    medium: Scratch<Medium>,
    wide: Scratch<Wide>,
}

impl Masker {
    /// One that uses these instructions, for comparing them.
    #[must_use]
    pub fn with_lanes(lanes: Lanes) -> Self {
        Self { lanes, ..Self::default() }
    }

    /// Makes `mask` the mask of `landmark` on `grid`. The stage of the statistics finds out where windows may match at
    /// all, that of the mask tests those exactly.
    ///
    /// # Panics
    /// When the grid's region does not lie inside the frame.
    pub fn find<P: StageProbe>(
        &mut self,
        frame: &Frame,
        grid: &DoubledGrid,
        landmark: &Landmark,
        mask: &mut BitMask,
        probe: &mut P,
    ) {
        probe.begin(Stage::Statistics);
        mask.reset(grid.mask_width(), grid.mask_height());
        self.accept(grid, landmark);
        self.find_areas(frame, grid);
        probe.end(Stage::Statistics);
        probe.begin(Stage::Mask);
        self.test_areas(frame, grid, mask);
        probe.end(Stage::Mask);
    }

    fn accept(&mut self, grid: &DoubledGrid, landmark: &Landmark) {
        let accepted = |shade| Acceptance::new(shade, &landmark.tolerance, grid.samples());
        self.accepted.clear();
        self.accepted.extend(landmark.shades.iter().filter_map(accepted));
    }

    /// Where windows may match.
    fn find_areas(&mut self, frame: &Frame, grid: &DoubledGrid) {
        self.areas.clear();
        if self.accepted.is_empty() {
            return;
        }
        if let Some(mesh) = Mesh::new(grid.window()) {
            let levels = |accepted| Levels::new(accepted, grid.samples(), mesh);
            self.levels.clear();
            self.levels.extend(self.accepted.iter().filter_map(levels));
            self.lanes.sift(&mut self.sieve, frame, grid, mesh, &self.levels);
            if self.sieve.alive_share() <= DENSE_SHARE {
                self.sieve.areas(mesh, grid.mask_height(), &mut self.areas);
                return;
            }
        }
        let blocks = grid.region().width.div_ceil(BLOCK_PX);
        self.areas.push(Area { rows: 0..grid.mask_height(), blocks: 0..blocks });
    }

    fn test_areas(&mut self, frame: &Frame, grid: &DoubledGrid, mask: &mut BitMask) {
        let question = Question { frame, grid, accepted: &self.accepted };
        for area in self.areas.iter().flat_map(|area| area.strips(STRIP_BLOCKS)) {
            if grid.samples() <= NARROW_SAMPLES {
                self.lanes.test_exactly(&question, &area, &mut self.narrow, mask);
            } else if grid.samples() <= MEDIUM_SAMPLES {
                self.lanes.test_exactly(&question, &area, &mut self.medium, mask);
            } else {
                self.lanes.test_exactly(&question, &area, &mut self.wide, mask);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RectPx;
    use crate::landmark::{ColorStats, Digest, ShapeClass, WindowPx};
    use crate::probe::NoProbe;
    use crate::reference;
    use crate::statistics::WindowSums;
    use proptest::prelude::*;

    fn landmark(window_px: WindowPx, shades: Vec<ColorStats>, tolerance: ColorStats) -> Landmark {
        Landmark {
            id: "test".into(),
            revision: 1,
            window_px,
            shades,
            tolerance,
            shape: ShapeClass::Any,
            size_m: None,
            digest: Digest::default(),
        }
    }

    /// Frames of a few flat patches with a little noise, so that masks are neither empty nor full.
    fn frames() -> impl Strategy<Value = Frame> {
        (1u32..70, 1u32..24, any::<u64>(), 0u8..9).prop_map(|(width, height, seed, noise)| {
            let mut state = seed | 1;
            let mut next = move || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 40) as u8
            };
            let colours: Vec<[u8; 3]> = (0..3).map(|_| [next(), next(), next()]).collect();
            let edge = (u32::from(next()) % width, u32::from(next()) % height);
            let pixel = |x, y| colours[usize::from(x > edge.0) + usize::from(y > edge.1)];
            let rgb = (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y)).collect::<Vec<_>>());
            let mut noisy = || if noise == 0 { 0 } else { next() % noise };
            let rgb =
                rgb.collect::<Vec<_>>().into_iter().map(|level| level.saturating_add(noisy())).collect();
            Frame::from_rgb(width, height, rgb).unwrap()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn every_variant_equals_the_definition(
            frame in frames(), width in 1u16..=32, height in 1u16..=32,
            at in (0.0f32..1.0, 0.0f32..1.0), second in (0.0f32..1.0, 0.0f32..1.0),
            mean in 0.0f32..60.0, variance in 0.0f32..400.0,
        ) {
            let window = WindowPx { width, height };
            let region = RectPx::whole(frame.size());
            let Some(grid) = DoubledGrid::new(region, window) else {
                return Ok(());
            };
            let shade = |at: (f32, f32)| {
                let place = |fraction: f32, most: u32| (fraction * most as f32) as u32;
                WindowSums::at(&frame, &grid, place(at.0, grid.mask_width()), place(at.1, grid.mask_height())).stats()
            };
            let landmark = landmark(window, vec![shade(at), shade(second)], ColorStats::uniform(mean, variance));
            let expected = reference::mask(&frame, region, &landmark).unwrap();
            for lanes in Lanes::available() {
                let mut mask = BitMask::default();
                Masker::with_lanes(lanes).find(&frame, &grid, &landmark, &mut mask, &mut NoProbe);
                prop_assert!(mask == expected, "{} differs", lanes.name());
            }
        }
    }
}
