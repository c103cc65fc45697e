//! Whatever frames and capture times come, following neither panics nor loses its numbers.

mod scene;

use proptest::prelude::*;
use scene::{red_landmark, set_of};
use vision::{
    ColorStats, Follow, FollowOptions, Frame, FrameStamp, Landmark, Mode, NoProbe, ShapeClass, Timestamp,
    WindowPx,
};

fn frames() -> impl Strategy<Value = Frame> {
    (0_u32..40, 0_u32..40, any::<u64>(), 0_u8..3).prop_map(|(width, height, seed, kind)| {
        let bytes = (0..3 * width * height).map(|k| match kind {
            0 => (seed >> (k % 8)) as u8,
            1 => (seed.wrapping_mul(u64::from(k) | 1) >> 24) as u8,
            _ => [205, 60, 40][(k % 3) as usize],
        });
        Frame::from_rgb(width, height, bytes.collect()).unwrap_or_default()
    })
}

fn odd_landmark(level: f32, shape: ShapeClass) -> Landmark {
    Landmark {
        id: "odd".into(),
        window_px: WindowPx { width: 3, height: 5 },
        shades: vec![ColorStats::uniform(level, 0.0), ColorStats::uniform(255.0 - level, 5000.0)],
        tolerance: ColorStats::uniform(0.0, 0.0),
        shape,
        ..red_landmark()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn following_survives(
        frames in proptest::collection::vec((frames(), any::<i64>()), 1..6),
        level in 0.0_f32..255.0,
        class in 0_usize..6,
        adaptive in any::<bool>(),
    ) {
        let mode = if adaptive { Mode::Adaptive } else { Mode::Faithful };
        let set = set_of(vec![odd_landmark(level, ShapeClass::ALL[class]), red_landmark()]);
        let mut follow = Follow::new(FollowOptions { mode, ..FollowOptions::default() }, set);
        for (sequence, (frame, nanos)) in frames.iter().enumerate() {
            let stamp = FrameStamp { sequence: sequence as u64, captured_at: Timestamp::from_nanos(*nanos) };
            let outcome = follow.on_frame(frame, stamp, &mut NoProbe);
            prop_assert!(outcome.landmarks.len() >= 2);
            for row in &outcome.landmarks {
                if let Ok(sighting) = &row.result {
                    prop_assert!(sighting.centroid.x.is_finite() && sighting.centroid.y.is_finite());
                    prop_assert!((0.0..=1.0).contains(&sighting.score), "{}", sighting.score);
                }
                if let Some(prior) = row.prediction {
                    prop_assert!(prior.covariance_px2.iter().all(|v| v.is_finite()));
                }
            }
        }
    }
}
