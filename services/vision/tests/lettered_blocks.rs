//! Toy blocks: a light face with a letter in a frame of the block's colour, some of them side by side.
#![allow(clippy::unwrap_used, reason = "scenes are built outside the test functions")]

mod scene;

use scene::{Block, GREY, RED, picture, seen, set_of, stamp};
use vision::{Follow, FollowOptions, Landmark, LearnOptions, Miss, NoProbe, RectPx, ShapeClass, learn};

const CREAM: [u8; 3] = [225, 212, 204];
const SIDE_PX: f32 = 44.0;

/// A frame, the face in it, and a letter of one bar.
fn lettered(x: f32, y: f32) -> [Block; 3] {
    let frame = Block::square(x, y, SIDE_PX, RED);
    let face = Block::square(x + 6.0, y + 6.0, SIDE_PX - 12.0, CREAM);
    let letter = Block { x: x + 18.0, y: y + 12.0, width: 8.0, height: 20.0, color: RED };
    [frame, face, letter]
}

fn landmark() -> Landmark {
    let frame = picture(&lettered(80.0, 60.0), 1.0, 1);
    let region = RectPx { x: 80, y: 60, width: SIDE_PX as u32, height: SIDE_PX as u32 };
    let options = LearnOptions { id: "red".into(), shape: ShapeClass::Block, ..LearnOptions::default() };
    learn(&[(&frame, region)], &options).unwrap()
}

#[test]
fn the_colour_that_goes_all_around_is_learned_and_not_the_face_in_it() {
    let shades = landmark().shades;
    let [shade] = &shades[..] else { panic!("{shades:?}") };
    for (mean, own) in shade.mean.iter().zip(RED) {
        assert!((mean - f32::from(own)).abs() < 6.0, "{shade:?}");
    }
}

#[test]
fn gloss_on_parts_of_the_frame_does_not_make_the_face_the_landmark() {
    let reds = [[205, 25, 35], [222, 50, 58], [230, 78, 86]];
    let [_, _, letter] = lettered(80.0, 60.0);
    let face = Block::square(88.0, 68.0, SIDE_PX - 16.0, CREAM);
    let bands = reds.iter().enumerate().map(|(band, &color)| {
        let height = SIDE_PX / 3.0;
        Block { x: 80.0, y: 60.0 + band as f32 * height, width: SIDE_PX, height, color }
    });
    let blocks: Vec<Block> = bands.chain([face, Block { color: reds[1], ..letter }]).collect();
    let region = RectPx { x: 80, y: 60, width: SIDE_PX as u32, height: SIDE_PX as u32 };
    let options = LearnOptions { shape: ShapeClass::Block, ..LearnOptions::default() };
    let learned = learn(&[(&picture(&blocks, 1.0, 1), region)], &options).unwrap();
    for shade in &learned.shades {
        assert!(shade.mean[0] - shade.mean[1] > 120.0, "{:?}", learned.shades);
    }
    let tones = |gloss: f32| learned.shades.iter().any(|shade| (shade.mean[1] - gloss).abs() < 12.0);
    assert!(tones(25.0) && tones(78.0), "{:?}", learned.shades);
}

#[test]
fn the_face_belongs_to_the_block() {
    let mut follow = Follow::new(FollowOptions::default(), set_of(vec![landmark()]));
    for k in 0..20 {
        let blocks = lettered(40.3 + 1.7 * k as f32, 50.0);
        let outcome = follow.on_frame(&picture(&blocks, 1.0, k), stamp(k), &mut NoProbe);
        let [(row, sighting)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        assert_eq!(row.instance, 0);
        assert!(
            sighting.centroid.distance_px(blocks[0].centre()) < 0.5,
            "frame {k}: {:?}",
            sighting.centroid
        );
        assert!(
            (sighting.area_px2 / (SIDE_PX * SIDE_PX) - 1.0).abs() < 0.06,
            "frame {k}: {}",
            sighting.area_px2
        );
    }
}

#[test]
fn a_finger_on_its_corner_does_not_hide_a_block() {
    let mut follow = Follow::new(FollowOptions::default(), set_of(vec![landmark()]));
    let [frame, face, letter] = lettered(60.0, 50.0);
    for k in 0..12 {
        let finger = Block { x: 60.0, y: 30.0, width: 14.0, height: 2.0 * k as f32, color: GREY };
        let outcome =
            follow.on_frame(&picture(&[frame, face, letter, finger], 1.0, k), stamp(k), &mut NoProbe);
        let [(row, sighting)] = seen(&outcome)[..] else { panic!("frame {k}: {:?}", outcome.landmarks) };
        assert_eq!(row.instance, 0);
        assert!(sighting.centroid.distance_px(frame.centre()) < 3.0, "frame {k}: {:?}", sighting.centroid);
    }
}

#[test]
fn a_covered_block_is_not_mistaken_for_its_neighbour() {
    let mut follow = Follow::new(FollowOptions::default(), set_of(vec![landmark()]));
    let (left, right) = (lettered(20.0, 50.0), lettered(120.0, 50.0));
    let cover = Block { x: 10.0, y: 40.0, width: 64.0, height: 64.0, color: GREY };
    let both: Vec<Block> = left.into_iter().chain(right).collect();
    let covered: Vec<Block> = both.iter().copied().chain([cover]).collect();
    for k in 0..50 {
        let blocks = if (20..40).contains(&k) { &covered } else { &both };
        let outcome = follow.on_frame(&picture(blocks, 1.0, k), stamp(k), &mut NoProbe);
        for (row, sighting) in seen(&outcome) {
            let on_left = sighting.centroid.distance_px(left[0].centre()) < 3.0;
            let on_right = sighting.centroid.distance_px(right[0].centre()) < 3.0;
            assert!(on_left || on_right, "frame {k}: {:?}", sighting.centroid);
            let first = seen_first(&outcome, row.instance);
            assert!(first, "frame {k}: instance {}", row.instance);
        }
        let expected = if (20..40).contains(&k) { 1 } else { 2 };
        assert_eq!(seen(&outcome).len(), expected, "frame {k}: {:?}", outcome.landmarks);
        if k == 30 {
            assert!(
                outcome
                    .landmarks
                    .iter()
                    .any(|row| matches!(row.result, Err(Miss::Occluded { .. } | Miss::OutsideGate { .. })))
            );
        }
    }
}

/// Whether only the two numbers of the first frame are in use.
fn seen_first(outcome: &vision::Outcome, instance: u32) -> bool {
    outcome.landmarks.len() <= 2 && instance < 2
}
