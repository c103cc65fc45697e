//! A block on a floor of nearly its own colour: the floor's shadow, and the floor itself under other light.

mod scene;

use scene::{Block, RED, picture, red_landmark, seen, set_of, stamp};
use vision::{ColorStats, Follow, FollowOptions, Landmark, NoProbe};

/// A little redder than the floor's shadow, which is (22, 47, 82).
const BLUE: [u8; 3] = [38, 48, 82];

fn landmark(mean: [f32; 3]) -> Landmark {
    let shade = ColorStats { mean, variance: [4.0; 3] };
    Landmark { id: "blue".into(), shades: vec![shade], ..red_landmark() }
}

fn moving(k: u32, color: [u8; 3]) -> Block {
    Block::square(20.3 + 2.1 * k as f32, 50.0 + 0.4 * k as f32, 24.0, color)
}

#[test]
fn a_shadow_of_nearly_its_colour_is_no_part_of_a_block() {
    let mut follow = Follow::new(FollowOptions::default(), set_of(vec![landmark(BLUE.map(f32::from))]));
    for k in 0..40 {
        let block = moving(k, BLUE);
        let outcome = follow.on_frame(&picture(&[block], 1.0, k), stamp(k), &mut NoProbe);
        let [(_, sighting)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        let off_px = sighting.centroid.distance_px(block.centre());
        assert!(off_px < 0.7, "frame {k}: off by {off_px} px");
        assert!((sighting.area_px2 / 576.0 - 1.0).abs() < 0.1, "frame {k}: {} px²", sighting.area_px2);
    }
}

#[test]
fn a_block_is_found_on_a_floor_that_would_be_its_colour_under_other_light() {
    // The floor is nearly this with 1.45 times as much light, and the block is this with 0.8 times as much.
    let landmark = landmark([42.0, 63.0, 102.0]);
    for k in 0..8 {
        let mut follow = Follow::new(FollowOptions::default(), set_of(vec![landmark.clone()]));
        let block = moving(10 + k, [34, 50, 82]);
        let outcome = follow.on_frame(&picture(&[block], 1.0, k), stamp(k), &mut NoProbe);
        let [(_, sighting)] = seen(&outcome)[..] else { panic!("picture {k}: {:?}", outcome.landmarks) };
        let off_px = sighting.centroid.distance_px(block.centre());
        assert!(off_px < 3.0, "picture {k}: off by {off_px} px");
    }
}

#[test]
fn a_shadow_alone_is_not_taken_for_a_block_of_its_colour() {
    let mut follow = Follow::new(FollowOptions::default(), set_of(vec![landmark(BLUE.map(f32::from))]));
    for k in 0..12 {
        let outcome = follow.on_frame(&picture(&[moving(k, RED)], 1.0, k), stamp(k), &mut NoProbe);
        assert!(seen(&outcome).is_empty(), "frame {k}: {:?}", outcome.landmarks);
    }
}
