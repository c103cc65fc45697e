//! Every variant of the mask against the definition.

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
    (1u32..70, 1u32..40, any::<u64>(), 0u8..9).prop_map(|(width, height, seed, noise)| {
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
        let rgb = rgb.collect::<Vec<_>>().into_iter().map(|level| level.saturating_add(noisy())).collect();
        Frame::from_rgb(width, height, rgb).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_variant_equals_the_definition(
        frame in frames(), width in 1u16..=32, height in 1u16..=32,
        at in (0.0f32..1.0, 0.0f32..1.0), second in (0.0f32..1.0, 0.0f32..1.0), off in -1.2f32..1.2,
        mean in 0.0f32..60.0, variance in 0.0f32..400.0, shades in 1usize..=2,
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
        let mut shades = [shade(at), shade(second)][..shades].to_vec();
        // Colours near those of the frame are the ones that need proof.
        shades[0].mean[usize::from(window.width % 3)] += off * mean;
        let landmark = landmark(window, shades, ColorStats::uniform(mean, variance));
        let expected = reference::mask(&frame, region, &landmark).unwrap();
        for lanes in Lanes::available() {
            let mut mask = BitMask::default();
            Masker::with_lanes(lanes).find(&frame, &grid, &landmark, &mut mask, &mut NoProbe);
            prop_assert!(mask == expected, "{} differs", lanes.name());
            let others = [landmark.tolerance, ColorStats::uniform(60.0, 900.0)].map(|tolerance| Landmark {
                shades: vec![shade(second)], tolerance, ..landmark.clone()
            });
            let all = [&others[0], &landmark, &others[1]];
            for sharing in [SHARED_BY, SHARED_BY_MANY] {
                let sought = all.into_iter().cycle().take(sharing).enumerate();
                let mut masker = Masker::with_lanes(lanes);
                masker.share(&frame, &sought.clone().map(|(number, one)| (number, grid, one)));
                for (number, one) in sought {
                    let expected = reference::mask(&frame, region, one).unwrap();
                    masker.find_shared(number, &frame, &grid, one, &mut mask, &mut NoProbe);
                    let name = lanes.name();
                    prop_assert!(mask == expected, "{name}: number {number} of {sharing} that share differs");
                }
            }
        }
    }
}
