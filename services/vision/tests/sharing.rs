//! Landmarks that share passes over a frame are found exactly as each would be alone.
#![allow(missing_docs, reason = "a test")]

use proptest::prelude::*;
use vision::{
    ColorStats, Digest, Frame, Landmark, Miss, NoProbe, Request, ShapeClass, Sighting, WindowPx, Workspace,
    register, register_all,
};

/// Stripes of four colours with a block on them, and noise.
fn frame(colours: &[[u8; 3]], noise: u8, seed: u64) -> Frame {
    let (width, height) = (150_u32, 90_u32);
    let mut state = seed | 1;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as u8 % (noise + 1)
    };
    let colour = |x: u32, y: u32| {
        let inside = (50..85).contains(&x) && (30..60).contains(&y);
        colours[if inside { 0 } else { 1 + (x / 55) as usize }]
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let rgb = pixels.flat_map(|(x, y)| colour(x, y)).map(|level| level.saturating_add(next())).collect();
    Frame::from_rgb(width, height, rgb).expect("three levels for each pixel")
}

type Found = Result<Vec<Sighting>, Miss>;

fn landmark(mean: [f32; 3], side: u16, tolerance: ColorStats) -> Landmark {
    Landmark {
        id: "any".into(),
        revision: 1,
        window_px: WindowPx::square(side),
        shades: vec![ColorStats { mean, variance: [5.0; 3] }],
        tolerance,
        shape: ShapeClass::Any,
        size_m: None,
        digest: Digest::default(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn landmarks_together_are_found_as_each_alone(
        colours: [[u8; 3]; 4], noise in 0u8..12, seed: u64,
        asked in prop::collection::vec((0usize..4, [-30.0f32..30.0, -30.0f32..30.0, -30.0f32..30.0],
            prop::sample::select(vec![6u16, 12, 13, 24]), 5.0f32..30.0, 20.0f32..300.0), 1..70),
    ) {
        let frame = frame(&colours, noise, seed);
        let landmarks: Vec<_> = asked.into_iter().map(|(colour, off, side, mean, variance)| {
            let near = [0, 1, 2].map(|channel| f32::from(colours[colour][channel]) + off[channel]);
            landmark(near, side, ColorStats::uniform(mean, variance))
        }).collect();
        let (request, mut workspace) = (Request::default(), Workspace::default());
        let alone: Vec<Found> = landmarks.iter()
            .map(|landmark| register(&frame, landmark, &request, &mut Workspace::default(), &mut NoProbe)).collect();
        let mut together: Vec<Found> = Vec::new();
        let each = |_, found, _: &mut Workspace| together.push(found);
        register_all(&frame, landmarks.iter(), &request, &mut workspace, &mut NoProbe, each);
        prop_assert_eq!(alone, together);
    }
}
