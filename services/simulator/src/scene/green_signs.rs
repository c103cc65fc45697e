//! Thesis 4.0.8: green signs stand beside the road, one each 200 feet; several are in view at once.

use super::Dice;
use super::lettering::{LETTERS, Line};
use super::roadside::{self, Road, SKY};
use crate::options::SceneOptions;
use crate::solids::{Board, rectangle};
use crate::vector::Vec3;
use crate::world::{Body, Colour, Item, Layer, Light, World};

/// 200 feet, metres.
const SPACING_M: f64 = 60.96;
const SIGNS: usize = 4;
/// How far the car drives: past all signs but the last, metres.
const DRIVE_M: f64 = 205.0;
const WHITE: Colour = [230.0, 234.0, 230.0];
const STEEL: Colour = [132.0, 134.0, 136.0];

pub(super) fn world(options: &SceneOptions, dice: &mut Dice, vehicle_dice: &mut Dice) -> World {
    let light = dice.light(0.66);
    let road =
        Road { right_edge_m: -2.2, left_edge_m: dice.within(5.0, 6.0), shoulder_m: dice.within(1.0, 2.5) };
    let green = dice.tinted([10.0, 112.0, 72.0], 8.0);
    let first_m = dice.within(36.0, 44.0);
    let mut items = Vec::new();
    for number in 1..=SIGNS {
        let x = first_m + SPACING_M * (number - 1) as f64;
        items.extend(sign(dice, &light, number, x, green));
    }
    let shadows = items.iter().flat_map(|item| light.shadows_of(item)).collect();
    items.extend(lamp_posts(dice, &light));
    items.extend(bushes(dice));
    items.extend(roadside::trees(dice, &light, [25.0, 330.0], [11.0, 30.0], 56));
    World {
        ground: roadside::ground(dice, road),
        backdrop: roadside::sky(dice),
        backdrop_place: SKY,
        shadows,
        items,
        drive: roadside::drive(options, DRIVE_M, vehicle_dice),
    }
}

/// A sign of three by one and a half metres with a white border and two lines of text, on two posts.
fn sign(dice: &mut Dice, light: &Light, number: usize, x: f64, green: Colour) -> Vec<Item> {
    let size = [dice.within(2.7, 3.2), dice.within(1.35, 1.6)];
    let centre = Vec3::new(x, -dice.within(5.0, 6.0), dice.within(2.2, 2.6));
    let board = Board { centre, yaw_rad: dice.around_zero(0.1) };
    let inner = size.map(|side| side - 0.14);
    let mut faces = vec![
        board.face(&rectangle([0.0, 0.0], size), WHITE, Layer::Surface, light),
        board.face(&rectangle([0.0, 0.0], inner), green, Layer::Paint, light),
    ];
    for (row, letters) in [(0.28, 6), (-0.3, 5)] {
        let text: Vec<u8> = (0..letters).map(|_| dice.one_of(LETTERS)).collect();
        let line =
            Line { middle: [0.0, row], letter_width: 0.18, letter_height: 0.28, stroke: 0.05, colour: WHITE };
        faces.extend(line.write(&text, board, light));
    }
    let post = |side: f64| {
        let foot = Vec3::new(x + 0.15, centre.y + side * size[0] / 3.0, 0.0);
        roadside::block(foot, Vec3::new(0.08, 0.1, centre.z + 0.3), STEEL, light)
    };
    vec![
        Item { name: Some(format!("sign-{number}")), centre, body: Body::Solid(faces) },
        post(-1.0),
        post(1.0),
    ]
}

/// Thin posts near the road, which pass in front of signs.
fn lamp_posts(dice: &mut Dice, light: &Light) -> Vec<Item> {
    (0..4)
        .map(|post| {
            let x = 20.0 + SPACING_M * f64::from(post) + dice.within(0.0, 10.0);
            roadside::block(
                Vec3::new(x, -dice.within(3.0, 3.6), 0.0),
                Vec3::new(0.12, 0.12, 6.0),
                STEEL,
                light,
            )
        })
        .collect()
}

/// Green bushes beyond the signs: their colour, not their shape.
fn bushes(dice: &mut Dice) -> Vec<Item> {
    (0..14)
        .map(|_| {
            let radius_m = dice.within(0.4, 1.0);
            let centre = Vec3::new(dice.within(30.0, 260.0), -dice.within(7.5, 10.0), radius_m * 0.5);
            let colour = dice.tinted([44.0, 98.0, 52.0], 14.0);
            Item { name: None, centre, body: Body::Ball { radius_m, colour } }
        })
        .collect()
}
