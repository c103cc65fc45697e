//! What both road scenes share: sky, ground, trees, posts, houses and the way of the car.

use super::Dice;
use crate::drive::Drive;
use crate::options::SceneOptions;
use crate::pattern::Clouds;
use crate::render::planes::Plane;
use crate::solids::standing_box;
use crate::texture::Texture;
use crate::vector::Vec3;
use crate::world::{BackdropPlace, Body, Colour, Face, Item, Layer, Light};

const GROUND_LOG2: u32 = 10;
const GROUND_TEXELS_PER_M: f64 = 12.5;
const SKY_LOG2: (u32, u32) = (10, 9);
const SKY_TEXELS_PER_M: f64 = 0.5;

/// The sky stands so far ahead that its perspective does not change.
pub(super) const SKY: BackdropPlace = BackdropPlace::Sky(1_000.0);

/// Across the road, metres to the left of the lane's middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Road {
    pub(super) right_edge_m: f64,
    pub(super) left_edge_m: f64,
    /// Width of the dirt on both sides.
    pub(super) shoulder_m: f64,
}

/// Asphalt with a dashed line, dirt beside it, grass beyond.
pub(super) fn ground(dice: &mut Dice, road: Road) -> Plane {
    let clouds = Clouds::new(dice.seed());
    let asphalt = dice.tinted([78.0, 78.0, 84.0], 8.0);
    let dirt = dice.tinted([152.0, 112.0, 76.0], 12.0);
    let grass = dice.tinted([88.0, 108.0, 54.0], 10.0);
    let texels = 1_usize << GROUND_LOG2;
    let period_m = texels as f64 / GROUND_TEXELS_PER_M;
    let middle_m = (road.right_edge_m + road.left_edge_m) / 2.0;
    let texture = Texture::paint(GROUND_LOG2, GROUND_LOG2, |column, row| {
        let (u, v) = (column as f64 / texels as f64, row as f64 / texels as f64);
        let y = if v > 0.5 { v - 1.0 } else { v } * period_m;
        let grain = clouds.at(u, v, 64, 4);
        let cloud = clouds.at(u, v, 8, 3);
        let ragged = y + 0.3 * grain;
        let beside_m = (road.right_edge_m - ragged).max(ragged - road.left_edge_m);
        if (y - middle_m).abs() < 0.08 && (u * 9.0).fract() < 0.4 {
            [196.0, 176.0, 92.0]
        } else if beside_m < 0.0 {
            asphalt.map(|level| level + 5.0 * grain + 4.0 * cloud)
        } else if beside_m < road.shoulder_m {
            dirt.map(|level| level + 14.0 * grain + 10.0 * cloud)
        } else {
            grass.map(|level| level + 16.0 * grain + 10.0 * cloud)
        }
    });
    Plane { texture, texels_per_m: GROUND_TEXELS_PER_M }
}

/// A sky that pales towards the horizon, over far wooded hills.
pub(super) fn sky(dice: &mut Dice) -> Plane {
    let clouds = Clouds::new(dice.seed());
    let zenith = dice.tinted([118.0, 158.0, 214.0], 12.0);
    let haze = dice.tinted([184.0, 202.0, 222.0], 8.0);
    let hills = dice.tinted([58.0, 80.0, 58.0], 8.0);
    let cover = dice.within(0.0, 22.0);
    let (width, height) = (1_usize << SKY_LOG2.0, 1_usize << SKY_LOG2.1);
    let texture = Texture::paint(SKY_LOG2.0, SKY_LOG2.1, |column, row| {
        let (u, v) = (column as f64 / width as f64, row as f64 / height as f64);
        let ridge_m = 20.0 + 8.0 * clouds.at(u, 0.2, 32, 3);
        if row as f64 / SKY_TEXELS_PER_M < ridge_m {
            return hills.map(|level| level + 10.0 * clouds.at(u, v, 64, 3));
        }
        let rise = (v * 1.8).min(1.0).sqrt();
        let cloud = cover * clouds.at(u, 2.0 * v, 8, 4).max(0.0);
        std::array::from_fn(|i| haze[i] + (zenith[i] - haze[i]) * rise + cloud)
    });
    Plane { texture, texels_per_m: SKY_TEXELS_PER_M }
}

/// The way of a car, `length_m` along its lane.
pub(super) fn drive(options: &SceneOptions, length_m: f64, dice: &mut Dice) -> Drive {
    Drive {
        length_m,
        one_way_s: f64::from(options.frames_one_way) / options.frame_rate_hz,
        head_start_s: f64::from(options.vehicle) * 0.7,
        offset_m: f64::from(options.vehicle % 3) * 0.15 - 0.15 + dice.around_zero(0.05),
        camera_height_m: dice.within(1.3, 1.5),
        camera_pitch_rad: dice.within(-0.02, 0.03),
        sway_m: vec![dice.wave(0.05..0.15, 0.008..0.02)],
        height_m: dice.vibration(0.01, 1.0..2.0),
        yaw_rad: dice.vibration(0.003, 0.5..1.0),
        pitch_rad: dice.vibration(0.002, 1.5..3.0),
        roll_rad: dice.vibration(0.003, 0.8..1.5),
    }
}

fn nameless(centre: Vec3, body: Body) -> Item {
    Item { name: None, centre, body }
}

/// A box of one colour that stands on the ground.
pub(super) fn block(foot: Vec3, size_m: Vec3, colour: Colour, light: &Light) -> Item {
    let faces = standing_box(foot, size_m, 0.0, light, |_| colour);
    nameless(foot + Vec3::new(0.0, 0.0, size_m.z / 2.0), Body::Solid(faces))
}

/// Rows of trees from `from_m` to `to_m` along both sides, `nearest_m` to `furthest_m` from the lane.
pub(super) fn trees(
    dice: &mut Dice,
    light: &Light,
    [from_m, to_m]: [f64; 2],
    [nearest_m, furthest_m]: [f64; 2],
    count: usize,
) -> Vec<Item> {
    let mut items = Vec::new();
    for tree in 0..count {
        let side = if tree % 2 == 0 { 1.0 } else { -1.0 };
        let x = from_m + (to_m - from_m) * (tree as f64 + dice.within(0.0, 1.0)) / count as f64;
        let y = side * dice.within(nearest_m, furthest_m);
        items.extend(self::tree(dice, light, Vec3::new(x, y, 0.0)));
    }
    items
}

/// A trunk and a crown of balls, the lower and inner ones darker.
fn tree(dice: &mut Dice, light: &Light, foot: Vec3) -> Vec<Item> {
    let height_m = dice.within(3.5, 6.5);
    let trunk_m = Vec3::new(0.25, 0.25, height_m * 0.5);
    let bark = dice.tinted([74.0, 56.0, 44.0], 8.0);
    let green = dice.tinted([62.0, 88.0, 46.0], 14.0);
    let mut items = vec![block(foot, trunk_m, bark, light)];
    for _ in 0..5 {
        let radius_m = height_m * dice.within(0.14, 0.26);
        let rise = dice.within(0.45, 0.95);
        let spread = height_m * 0.24;
        let offset = Vec3::new(dice.around_zero(spread), dice.around_zero(spread), height_m * rise);
        let colour = green.map(|level| level * (0.6 + 0.5 * rise) * light.ambient.max(0.7));
        let colour = dice.tinted(colour, 5.0);
        items.push(nameless(foot + offset, Body::Ball { radius_m, colour }));
    }
    items
}

/// A brick house with a dark gable roof; its front, with two windows, faces the camera.
pub(super) fn house(dice: &mut Dice, light: &Light, foot: Vec3) -> Vec<Item> {
    let size_m = Vec3::new(dice.within(5.0, 8.0), dice.within(6.0, 9.0), dice.within(2.6, 3.4));
    let brick = dice.tinted([150.0, 62.0, 54.0], 10.0);
    let mut faces = standing_box(foot, size_m, 0.0, light, |_| brick);
    let front = Vec3::new(foot.x - size_m.x / 2.0, foot.y, size_m.z * 0.55);
    for side in [-1.0, 1.0] {
        let centre = front + Vec3::new(0.0, side * size_m.y / 4.0, 0.0);
        let corners = [[-0.6, -0.6], [0.6, -0.6], [0.6, 0.6], [-0.6, 0.6]]
            .map(|[u, v]| centre + Vec3::new(0.0, -u, v))
            .to_vec();
        let normal = Vec3::new(-1.0, 0.0, 0.0);
        faces.push(Face { corners, normal, colour: [96.0, 104.0, 116.0], layer: Layer::Paint });
    }
    let walls = nameless(foot + Vec3::new(0.0, 0.0, size_m.z / 2.0), Body::Solid(faces));
    vec![walls, roof(foot, size_m, light)]
}

fn roof(foot: Vec3, size_m: Vec3, light: &Light) -> Item {
    let (deep, wide) = (size_m.x / 2.0 + 0.3, size_m.y / 2.0 + 0.3);
    let at = |x: f64, y: f64, z: f64| foot + Vec3::new(x, y, size_m.z + z);
    let front = [at(-deep, wide, 0.0), at(-deep, -wide, 0.0), at(0.0, -wide, 1.8), at(0.0, wide, 1.8)];
    let normal = Vec3::new(-1.8, 0.0, deep).normalised();
    let face = Face {
        corners: front.to_vec(),
        normal,
        colour: light.shade([92.0, 84.0, 84.0], normal),
        layer: Layer::Surface,
    };
    nameless(at(0.0, 0.0, 0.9), Body::Solid(vec![face]))
}
