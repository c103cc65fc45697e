//! Following a block through what happens to blocks: light, shadow, occlusion, look-alikes, leaving the picture.

mod scene;

use scene::{Block, GREY, HEIGHT, RED, WIDTH, picture, red_landmark, seen, set_of, stamp};
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::{Follow, FollowOptions, Frame, Landmark, Miss, Mode, NoProbe, ShapeClass};

fn follower() -> Follow {
    Follow::new(FollowOptions::default(), set_of(vec![red_landmark()]))
}

fn moving(k: u32) -> Block {
    Block::square(20.3 + 2.1 * k as f32, 50.0 + 0.4 * k as f32, 22.0, RED)
}

#[test]
fn a_block_is_measured_to_a_fraction_of_a_pixel_from_the_first_frame_on() {
    let mut follow = follower();
    for k in 0..40 {
        let block = moving(k);
        let outcome = follow.on_frame(&picture(&[block], 1.0, k), stamp(k), &mut NoProbe);
        let [(row, sighting)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        assert_eq!(row.instance, 0);
        assert!(sighting.centroid.distance_px(block.centre()) < 0.3, "frame {k}: {:?}", sighting.centroid);
        assert!((sighting.area_px2 / 484.0 - 1.0).abs() < 0.06, "frame {k}: {}", sighting.area_px2);
        assert!(sighting.outline.len() >= 4);
    }
}

#[test]
fn a_face_turned_to_the_light_belongs_to_its_block() {
    let mut follow = follower();
    for k in 0..40 {
        let front = Block { color: [180, 53, 35], ..moving(k) };
        let top = Block { y: front.y - 6.0, height: 6.0, color: [255, 75, 50], ..front };
        let encoded = encode_jpeg(&picture(&[front, top], 1.0, k), Quality::default()).unwrap();
        let frame = decode(&encoded, &DecodeLimits::default()).unwrap();
        let outcome = follow.on_frame(&frame, stamp(k), &mut NoProbe);
        let [(_, sighting)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        let whole = Block { y: top.y, height: front.height + 6.0, ..front };
        let off_px = sighting.centroid.distance_px(whole.centre());
        assert!(off_px < 0.3, "frame {k}: off by {off_px} px, {} px²", sighting.area_px2);
    }
}

#[test]
fn a_swing_of_the_light_is_followed_and_reported() {
    let mut follow = follower();
    for k in 0..60 {
        let gain = 1.0 + 0.25 * (k as f32 / 8.0).sin();
        let outcome = follow.on_frame(&picture(&[moving(k)], gain, k), stamp(k), &mut NoProbe);
        let [(row, _)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        let adaptation = row.adaptation.unwrap();
        let reported = adaptation.gain;
        assert!((reported / gain - 1.0).abs() < 0.1, "frame {k}: {reported} for {gain}");
        // Tolerances widen with the distance from the descriptor's light, and that is told too.
        let departure = (reported - 1.0).abs();
        assert_eq!(adaptation.tolerance_scale > 1.05, departure > 0.03, "frame {k}: {adaptation:?}");
    }
}

#[test]
fn haze_that_comes_and_goes_is_followed_and_reported() {
    let mut follow = follower();
    for k in 0..70 {
        let haze = 50.0 * (k as f32 / 14.0).sin().max(-0.4);
        let clear = picture(&[moving(k)], 1.0, k);
        let hazy = clear.rgb().iter().map(|&level| (f32::from(level) + haze).clamp(0.0, 255.0) as u8);
        let frame = Frame::from_rgb(clear.width(), clear.height(), hazy.collect()).unwrap();
        let outcome = follow.on_frame(&frame, stamp(k), &mut NoProbe);
        let [(row, sighting)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        assert!(sighting.centroid.distance_px(moving(k).centre()) < 0.5, "frame {k}");
        let adaptation = row.adaptation.unwrap();
        assert!((adaptation.haze - haze).abs() < 15.0, "frame {k}: {adaptation:?} for {haze}");
    }
}

#[test]
fn an_occluded_block_is_said_to_be_covered_and_taken_up_again_with_its_number() {
    let mut follow = follower();
    let post = Block { x: 70.0, y: 20.0, width: 40.0, height: 100.0, color: GREY };
    let mut covered = 0;
    for k in 0..60 {
        let outcome = follow.on_frame(&picture(&[moving(k), post], 1.0, k), stamp(k), &mut NoProbe);
        let hidden = moving(k).x >= post.x && moving(k).x + 22.0 <= post.x + post.width;
        let found = seen(&outcome);
        if hidden {
            assert!(found.is_empty(), "frame {k}: {:?}", found[0].1.centroid);
            covered += u32::from(matches!(outcome.landmarks[0].result, Err(Miss::Occluded { .. })));
        }
        if !(15..=50).contains(&k) {
            assert_eq!(found.len(), 1, "frame {k}: {:?}", outcome.landmarks);
            assert_eq!(found[0].0.instance, 0, "frame {k}");
        }
    }
    assert!(covered >= 3, "said to be covered in {covered} frames only");
}

#[test]
fn what_something_leaves_of_a_block_in_view_is_followed() {
    let mut follow = follower();
    let post = Block { x: 80.0, y: 20.0, width: 60.0, height: 100.0, color: GREY };
    for k in 0..30 {
        let block = moving(k);
        let outcome = follow.on_frame(&picture(&[block, post], 1.0, k), stamp(k), &mut NoProbe);
        let in_view_px = post.x - block.x;
        if in_view_px < 11.0 {
            break;
        }
        let [(row, sighting)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        assert_eq!(row.instance, 0, "frame {k}");
        assert!(sighting.centroid.x < post.x, "frame {k}: {:?}", sighting.centroid);
        assert!((sighting.centroid.y - block.centre().y).abs() < 2.0, "frame {k}: {:?}", sighting.centroid);
        let expected_px2 = 22.0 * in_view_px.min(22.0);
        assert!((sighting.area_px2 / expected_px2 - 1.0).abs() < 0.2, "frame {k}: {}", sighting.area_px2);
    }
}

#[test]
fn a_block_that_leaves_is_not_claimed_of_what_stays() {
    let mut follow = follower();
    let mut lookalike = Block::square(150.0, 110.0, 20.0, [150, 90, 70]);
    lookalike.width = 30.0;
    for k in 0..70 {
        let block = Block::square(WIDTH as f32 - 60.0 + 2.0 * k as f32, 30.0, 22.0, RED);
        let outcome = follow.on_frame(&picture(&[lookalike, block], 1.0, k), stamp(k), &mut NoProbe);
        let found = seen(&outcome);
        if block.x >= WIDTH as f32 {
            assert!(found.is_empty(), "frame {k}: {:?}", found[0].1.centroid);
        } else if block.x + 22.0 <= WIDTH as f32 {
            assert_eq!(found.len(), 1, "frame {k}");
            assert!(found[0].1.centroid.distance_px(block.centre()) < 1.0, "frame {k}");
        }
    }
    let outcome = follow.on_frame(&picture(&[lookalike], 1.0, 99), stamp(70), &mut NoProbe);
    assert_eq!(outcome.landmarks[0].result, Err(Miss::OutsideFrame));
}

#[test]
fn a_block_that_is_in_view_elsewhere_is_not_waited_for_where_it_was() {
    let mut follow = follower();
    // Small and far away after the leap, it never looks as much like the landmark as it did before.
    let (before, after) = (Block::square(20.0, 40.0, 26.0, RED), Block::square(150.0, 90.0, 11.0, RED));
    for k in 0..120 {
        let block = if k < 30 { before } else { after };
        let outcome = follow.on_frame(&picture(&[block], 1.0, k), stamp(k), &mut NoProbe);
        let [(row, _)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        assert_eq!(row.instance, u32::from(k >= 30), "frame {k}");
        let waited_for = outcome.landmarks.len() - 1;
        assert!(waited_for == 0 || (30..90).contains(&k), "frame {k}: {:?}", outcome.landmarks);
    }
}

#[test]
fn two_blocks_of_one_landmark_keep_their_numbers() {
    let mut follow = follower();
    for k in 0..40 {
        let (left, right) = (
            Block::square(20.0 + k as f32, 40.0, 22.0, RED),
            Block::square(150.0 - k as f32, 90.0, 22.0, RED),
        );
        let outcome = follow.on_frame(&picture(&[left, right], 1.0, k), stamp(k), &mut NoProbe);
        let found = seen(&outcome);
        assert_eq!(found.len(), 2, "frame {k}: {:?}", outcome.landmarks);
        let at = |instance: u32| found.iter().find(|(row, _)| row.instance == instance).unwrap().1.centroid;
        let first_is_left = at(0).distance_px(left.centre()) < 1.0 && at(1).distance_px(right.centre()) < 1.0;
        let first_is_right =
            at(1).distance_px(left.centre()) < 1.0 && at(0).distance_px(right.centre()) < 1.0;
        assert!(first_is_left || first_is_right, "frame {k}");
        if k == 0 {
            continue;
        }
        assert!(found.iter().all(|(row, _)| row.innovation_px.is_some()), "frame {k}: a new number");
    }
}

#[test]
fn a_state_taken_between_frames_continues_as_if_nothing_had_happened() {
    for mode in [Mode::Faithful, Mode::Adaptive] {
        let options = FollowOptions { mode, ..FollowOptions::default() };
        let set = set_of(vec![red_landmark()]);
        let mut whole = Follow::new(options, set.clone());
        for k in 0..6 {
            whole.on_frame(&picture(&[moving(k)], 1.0, k), stamp(k), &mut NoProbe);
        }
        let mut resumed = Follow::restore(options, set, whole.state().clone());
        for k in 6..12 {
            let frame = picture(&[moving(k)], 1.0, k);
            let outcomes =
                [&mut whole, &mut resumed].map(|follow| follow.on_frame(&frame, stamp(k), &mut NoProbe));
            assert_eq!(outcomes[0], outcomes[1], "{mode:?} frame {k}");
        }
    }
}

#[test]
fn a_changed_landmark_starts_anew_and_the_others_keep_their_tracks() {
    let mut follow = follower();
    follow.on_frame(&picture(&[moving(0)], 1.0, 0), stamp(0), &mut NoProbe);
    let mut other = red_landmark();
    other.id = "zebra".into();
    follow.set_landmarks(set_of(vec![red_landmark(), other]));
    let outcome = follow.on_frame(&picture(&[moving(1)], 1.0, 1), stamp(1), &mut NoProbe);
    assert!(outcome.landmarks[0].prediction.is_some());
    assert!(outcome.landmarks[1].prediction.is_none());
}

#[test]
fn ten_thousand_landmarks_are_bounded_and_what_was_skipped_gets_its_turn() {
    let red = red_landmark();
    let landmarks = (0..10_000).map(|k| Landmark { id: format!("red-{k:05}"), ..red.clone() });
    let frame_px = u64::from(WIDTH * HEIGHT);
    let options = FollowOptions { budget_px: 8 * frame_px, ..FollowOptions::default() };
    let mut follow = Follow::new(options, set_of(landmarks.collect()));
    let frame = picture(&[], 1.0, 1);
    let looked_for = |follow: &mut Follow, k: u32| -> Vec<usize> {
        let outcome = follow.on_frame(&frame, stamp(k), &mut NoProbe);
        assert_eq!(outcome.landmarks.len(), 10_000);
        let rows = outcome.landmarks.iter().enumerate();
        rows.filter(|(_, row)| row.result != Err(Miss::Skipped)).map(|(at, _)| at).collect()
    };
    assert_eq!(looked_for(&mut follow, 0), (0..8).collect::<Vec<_>>());
    assert_eq!(looked_for(&mut follow, 1), (8..16).collect::<Vec<_>>());
}

#[test]
fn more_instances_than_allowed_are_told() {
    let mut landmark = red_landmark();
    landmark.shape = ShapeClass::Any;
    let options = FollowOptions { max_instances: 3, ..FollowOptions::default() };
    let mut follow = Follow::new(options, set_of(vec![landmark]));
    let blocks: Vec<Block> = (0..6)
        .map(|k| Block::square(10.0 + 30.0 * k as f32, f32::from(HEIGHT as u16) / 2.0, 16.0, RED))
        .collect();
    let outcome = follow.on_frame(&picture(&blocks, 1.0, 1), stamp(0), &mut NoProbe);
    assert_eq!(seen(&outcome).len(), 3);
    assert!(outcome.landmarks.iter().any(|row| row.result == Err(Miss::Skipped)));
}

#[test]
fn a_block_is_found_beside_something_larger_of_its_colour_and_a_last_sliver_is_not_claimed() {
    let mut follow = follower();
    let wall = Block { x: 0.0, y: 0.0, width: WIDTH as f32, height: 40.0, color: RED };
    for k in 0..40 {
        let block = Block::square(100.0 + 3.0 * k as f32, 70.0, 22.0, RED);
        let outcome = follow.on_frame(&picture(&[wall, block], 1.0, k), stamp(k), &mut NoProbe);
        let found = seen(&outcome);
        let left = WIDTH as f32 - block.x;
        if left >= 22.0 {
            let near = found.iter().any(|(_, sighting)| sighting.centroid.distance_px(block.centre()) < 1.0);
            assert!(near, "frame {k}: {:?}", outcome.landmarks);
        } else if left < 1.0 {
            let claimed = found.iter().any(|(_, sighting)| sighting.centroid.y > 50.0);
            assert!(!claimed, "frame {k}: {:?}", outcome.landmarks);
        }
    }
}
