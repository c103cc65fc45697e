//! Thesis 4.0.7: a car drives up to a stop sign; a railroad crossbuck behind it, trees, dirt, and other red things.

use super::Dice;
use super::lettering::Line;
use super::roadside::{self, Road, SKY};
use crate::options::SceneOptions;
use crate::solids::{Board, rectangle};
use crate::vector::Vec3;
use crate::world::{Body, Colour, Item, Layer, Light, Shadow, World};

/// Red as kerbs and cars have it.
const PAINT: Colour = [176.0, 38.0, 42.0];

/// Width of the sign over its flats, metres (the common 30 inch sign).
const SIGN_M: f64 = 0.75;
/// How far the car drives, and how far from the sign it ends; metres.
const DRIVE_M: f64 = 43.0;
const WHITE: Colour = [232.0, 232.0, 230.0];
const STEEL: Colour = [128.0, 130.0, 132.0];

pub(super) fn world(options: &SceneOptions, dice: &mut Dice, vehicle_dice: &mut Dice) -> World {
    let light = dice.light(0.66);
    let road =
        Road { right_edge_m: -1.9, left_edge_m: dice.within(4.5, 6.0), shoulder_m: dice.within(2.0, 4.5) };
    let place = Vec3::new(DRIVE_M + dice.within(6.3, 7.2), -dice.within(2.7, 3.3), dice.within(2.0, 2.3));
    let mut items = sign(dice, &light, place);
    let beside = Vec3::new(place.x + dice.within(4.0, 8.0), place.y - dice.within(0.0, 0.8), 0.0);
    items.extend(crossbuck(&light, beside));
    let solid_until = items.len();
    items.extend(clutter(dice, &light, road));
    let shadows = shadows(&light, &items, solid_until);
    items.extend(roadside::trees(dice, &light, [22.0, 120.0], [road.left_edge_m + 3.0, 22.0], 46));
    World {
        ground: roadside::ground(dice, road),
        backdrop: roadside::sky(dice),
        backdrop_place: SKY,
        shadows,
        items,
        drive: roadside::drive(options, DRIVE_M, vehicle_dice),
    }
}

fn shadows(light: &Light, items: &[Item], until: usize) -> Vec<Shadow> {
    items[..until].iter().flat_map(|item| light.shadows_of(item)).collect()
}

/// An octagon with a flat top, `width` over its flats.
fn octagon(width: f64) -> [[f64; 2]; 8] {
    let radius = width / 2.0 / (std::f64::consts::PI / 8.0).cos();
    std::array::from_fn(|i| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_4 * (i as f64 + 0.5)).sin_cos();
        [radius * cos, radius * sin]
    })
}

/// The sign on its post.
fn sign(dice: &mut Dice, light: &Light, centre: Vec3) -> Vec<Item> {
    let board = Board { centre, yaw_rad: dice.around_zero(0.12) };
    let red = dice.tinted([196.0, 26.0, 36.0], 8.0);
    let mut faces = vec![
        board.face(&octagon(SIGN_M), WHITE, Layer::Surface, light),
        board.face(&octagon(SIGN_M * 0.94), red, Layer::Paint, light),
    ];
    let line =
        Line { middle: [0.0, 0.0], letter_width: 0.085, letter_height: 0.2, stroke: 0.032, colour: WHITE };
    faces.extend(line.write(b"STOP", board, light));
    let post_m = Vec3::new(0.05, 0.07, centre.z);
    let post = roadside::block(Vec3::new(centre.x + 0.06, centre.y, 0.0), post_m, STEEL, light);
    vec![Item { name: Some("sign".to_owned()), centre, body: Body::Solid(faces) }, post]
}

/// Two white planks crossed on a white post.
fn crossbuck(light: &Light, foot: Vec3) -> Vec<Item> {
    let centre = foot + Vec3::new(0.0, 0.0, 2.8);
    let planks = [1.0, -1.0].into_iter().enumerate().map(|(order, lean)| {
        let (sin, cos) = (lean * std::f64::consts::FRAC_PI_4).sin_cos();
        let outline =
            rectangle([0.0, 0.0], [1.22, 0.23]).map(|[u, v]| [u * cos - v * sin, u * sin + v * cos]);
        let centre = centre + Vec3::new(0.02 * order as f64, 0.0, 0.0);
        let face = Board { centre, yaw_rad: 0.0 }.face(&outline, WHITE, Layer::Surface, light);
        Item { name: None, centre, body: Body::Solid(vec![face]) }
    });
    let post_m = Vec3::new(0.1, 0.12, 2.9);
    let post = roadside::block(foot + Vec3::new(0.1, 0.0, 0.0), post_m, [214.0, 214.0, 210.0], light);
    planks.chain([post]).collect()
}

/// Red kerbs, posts and brick houses, none of which is a sign.
fn clutter(dice: &mut Dice, light: &Light, road: Road) -> Vec<Item> {
    let mut items = Vec::new();
    let red = dice.tinted([182.0, 34.0, 38.0], 14.0);
    let left_m = road.left_edge_m + 0.3;
    for kerb in 0..dice.within(3.0, 8.0) as usize {
        let foot = Vec3::new(14.0 + 5.0 * kerb as f64 + dice.around_zero(1.0), left_m, 0.0);
        items.push(roadside::block(foot, Vec3::new(1.6, 0.3, 0.18), red, light));
    }
    for _ in 0..dice.within(2.0, 6.0) as usize {
        let side_m = if dice.chance(0.5) { left_m + dice.within(0.5, 2.0) } else { -dice.within(4.2, 6.0) };
        let foot = Vec3::new(dice.within(20.0, 60.0), side_m, 0.0);
        items.push(roadside::block(foot, Vec3::new(0.14, 0.14, dice.within(0.7, 1.1)), red, light));
    }
    for side in [-1.0, 1.0] {
        let foot = Vec3::new(dice.within(55.0, 90.0), side * dice.within(11.0, 17.0), 0.0);
        items.extend(roadside::house(dice, light, foot));
    }
    items
}

/// What a real street adds: kerbs painted red on both sides all the way to the sign, and parked red cars.
pub(super) fn street(dice: &mut Dice) -> Vec<Item> {
    let light = dice.light(0.66);
    let mut items = Vec::new();
    for (side_m, from_m) in [(-2.1, dice.within(8.0, 20.0)), (6.3, dice.within(4.0, 30.0))] {
        for piece in 0..12 {
            let foot = Vec3::new(from_m + 3.0 * f64::from(piece), side_m, 0.0);
            let red = dice.tinted(PAINT, 14.0);
            items.push(roadside::block(foot, Vec3::new(2.9, 0.25, 0.15), red, &light));
        }
    }
    for _ in 0..dice.within(1.0, 4.0) as usize {
        let side_m = if dice.chance(0.6) { dice.within(7.6, 9.0) } else { -dice.within(5.5, 7.5) };
        let foot = Vec3::new(dice.within(15.0, 70.0), side_m, 0.0);
        items.extend(car(dice, &light, foot));
    }
    items
}

/// A body, a cabin with dark windows, and wheels.
fn car(dice: &mut Dice, light: &Light, foot: Vec3) -> Vec<Item> {
    let paint = dice.tinted([186.0, 28.0, 34.0], 16.0);
    let at = |x: f64, y: f64, z: f64| foot + Vec3::new(x, y, z);
    let raised = |from: Vec3, size_m: Vec3, colour: Colour| {
        let item = roadside::block(Vec3::new(from.x, from.y, 0.0), size_m, colour, light);
        item.raised(from.z)
    };
    let mut items = vec![
        raised(at(0.0, 0.0, 0.3), Vec3::new(4.2, 1.75, 0.55), paint),
        raised(at(0.3, 0.0, 0.85), Vec3::new(2.1, 1.55, 0.42), [38.0, 42.0, 48.0]),
        raised(at(0.4, 0.0, 1.27), Vec3::new(1.7, 1.45, 0.08), paint),
    ];
    for (x, y) in [(-1.4, -0.8), (-1.4, 0.8), (1.4, -0.8), (1.4, 0.8)] {
        items.push(raised(at(x, y, 0.0), Vec3::new(0.6, 0.2, 0.6), [28.0, 28.0, 30.0]));
    }
    items
}
