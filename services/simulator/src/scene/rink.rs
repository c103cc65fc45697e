//! Thesis 3.2: four blocks on a rink with a smooth blue, a white sandy and a pebbled floor, before a dark wall with
//! a window and bricks; a camera on a cart is pushed towards them.

use super::Dice;
use crate::drive::Drive;
use crate::options::SceneOptions;
use crate::pattern::Clouds;
use crate::render::planes::Plane;
use crate::solids::standing_box;
use crate::texture::Texture;
use crate::vector::Vec3;
use crate::world::{BackdropPlace, Body, Colour, Item, Light, Shadow, World};

/// Length of a block's edge, metres.
const BLOCK_M: f64 = 0.1;
const BLOCKS: [(&str, Colour); 4] = [
    ("red", [222.0, 66.0, 30.0]),
    ("blue", [52.0, 64.0, 112.0]),
    ("black", [22.0, 22.0, 26.0]),
    ("tan", [222.0, 180.0, 112.0]),
];
/// How far the cart is pushed, metres.
const PUSH_M: f64 = 2.0;

const FLOOR_LOG2: u32 = 10;
const FLOOR_TEXELS_PER_M: f64 = 160.0;
const WALL_LOG2: (u32, u32) = (10, 9);
const WALL_TEXELS_PER_M: f64 = 128.0;

pub(super) fn world(options: &SceneOptions, dice: &mut Dice, vehicle_dice: &mut Dice) -> World {
    let light = dice.light(0.72);
    let items = blocks(dice, &light);
    let shadows: Vec<Shadow> = items.iter().flat_map(|item| light.shadows_of(item)).collect();
    World {
        ground: Plane { texture: floor(dice), texels_per_m: FLOOR_TEXELS_PER_M },
        backdrop: Plane { texture: wall(dice), texels_per_m: WALL_TEXELS_PER_M },
        backdrop_place: BackdropPlace::Wall(dice.within(5.0, 5.8)),
        shadows,
        items,
        drive: drive(options, vehicle_dice),
    }
}

/// One block in each of four lanes, in any order, so that none hides another at the start.
fn blocks(dice: &mut Dice, light: &Light) -> Vec<Item> {
    let mut lanes_m = [-0.72, -0.24, 0.24, 0.72];
    dice.shuffle(&mut lanes_m);
    BLOCKS
        .into_iter()
        .zip(lanes_m)
        .map(|((name, colour), lane_m)| {
            let foot = Vec3::new(dice.within(2.5, 3.5), lane_m + dice.around_zero(0.15), 0.0);
            let colour = dice.tinted(colour, 6.0);
            let yaw_rad = dice.around_zero(std::f64::consts::FRAC_PI_4);
            let size_m = Vec3::new(BLOCK_M, BLOCK_M, BLOCK_M);
            let faces = standing_box(foot, size_m, yaw_rad, light, |_| colour);
            let centre = foot + Vec3::new(0.0, 0.0, BLOCK_M / 2.0);
            Item { name: Some(name.to_owned()), centre, body: Body::Solid(faces) }
        })
        .collect()
}

fn drive(options: &SceneOptions, dice: &mut Dice) -> Drive {
    let lane_m = f64::from(options.vehicle % 3) * 0.06 - 0.06;
    Drive {
        length_m: PUSH_M,
        one_way_s: f64::from(options.frames_one_way) / options.frame_rate_hz,
        head_start_s: f64::from(options.vehicle) * 0.4,
        offset_m: lane_m + dice.around_zero(0.02),
        camera_height_m: dice.within(0.38, 0.44),
        camera_pitch_rad: dice.within(0.0, 0.06),
        sway_m: vec![dice.wave(0.01..0.025, 0.2..0.45)],
        height_m: dice.vibration(0.001, 2.0..4.0),
        yaw_rad: dice.vibration(0.003, 0.7..1.5),
        pitch_rad: dice.vibration(0.0018, 3.0..5.0),
        roll_rad: dice.vibration(0.003, 0.8..2.0),
    }
}

/// Where each kind of floor lies, and how it looks.
struct Floor {
    fine: Clouds,
    coarse: Clouds,
    /// The pebbles end here, seen from the camera: x, metres.
    pebbles_end_m: f64,
    /// Their border towards the sand: y at x = 0, metres, and its slope.
    pebbles_border_m: f64,
    pebbles_slope: f64,
    /// +1 where the pebbles lie on the left, −1 on the right.
    pebbles_side: f64,
    /// The sand ends about here, metres, and its border is that uneven.
    sand_end_m: f64,
    sand_wave_m: f64,
    /// A red line on the blue floor: its x and its slope.
    line_m: f64,
    line_slope: f64,
    blue: Colour,
    sand: Colour,
    gravel: Colour,
}

impl Floor {
    fn new(dice: &mut Dice) -> Self {
        Self {
            fine: Clouds::new(dice.seed()),
            coarse: Clouds::new(dice.seed()),
            pebbles_end_m: dice.within(1.7, 2.4),
            pebbles_border_m: dice.within(-0.1, 0.4),
            pebbles_slope: dice.within(0.0, 0.25),
            pebbles_side: if dice.chance(0.5) { 1.0 } else { -1.0 },
            sand_end_m: dice.within(1.5, 2.2),
            sand_wave_m: dice.within(0.1, 0.35),
            line_m: dice.within(2.0, 2.45),
            line_slope: dice.around_zero(0.06),
            blue: dice.tinted([58.0, 112.0, 205.0], 8.0),
            sand: dice.tinted([202.0, 194.0, 178.0], 8.0),
            gravel: dice.tinted([104.0, 92.0, 80.0], 8.0),
        }
    }

    /// The floor without stones at (`x`, `y`) metres; `u` and `v` are the same place as parts of the texture.
    fn colour(&self, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Colour {
        let grain = self.fine.at(u, v, 64, 3);
        let cloud = self.coarse.at(u, v, 8, 3);
        if self.is_pebbled(x + 0.02 * grain, y + 0.02 * cloud) {
            return self.gravel.map(|level| level + 16.0 * grain + 6.0 * cloud);
        }
        let border_m = self.sand_end_m + self.sand_wave_m * self.coarse.at(v, 0.37, 8, 2);
        if x < border_m {
            return self.sand.map(|level| level + 9.0 * grain + 5.0 * cloud);
        }
        if (x - self.line_m - self.line_slope * y).abs() < 0.007 {
            return [190.0, 70.0, 80.0];
        }
        self.blue.map(|level| level + 4.0 * grain + 7.0 * cloud)
    }

    fn is_pebbled(&self, x: f64, y: f64) -> bool {
        x < self.pebbles_end_m && self.pebbles_side * y > self.pebbles_border_m - self.pebbles_slope * x
    }
}

fn floor(dice: &mut Dice) -> Texture {
    let floor = Floor::new(dice);
    let texels = 1_usize << FLOOR_LOG2;
    // The texture repeats; metres run from 0 along x and around 0 along y.
    let metres = |column: usize, row: usize| {
        let y = row as f64 / FLOOR_TEXELS_PER_M;
        let width_m = texels as f64 / FLOOR_TEXELS_PER_M;
        [column as f64 / FLOOR_TEXELS_PER_M, if y > width_m / 2.0 { y - width_m } else { y }]
    };
    let mut colours: Vec<Colour> = (0..texels * texels)
        .map(|at| {
            let (column, row) = (at % texels, at / texels);
            floor.colour(metres(column, row), [column, row].map(|i| i as f64 / texels as f64))
        })
        .collect();
    for _ in 0..45_000 {
        scatter_stone(dice, texels, &mut colours, |column, row| {
            let [x, y] = metres(column, row);
            floor.is_pebbled(x, y)
        });
    }
    Texture::paint(FLOOR_LOG2, FLOOR_LOG2, |column, row| colours[row * texels + column])
}

/// Lays one stone, an ellipse of 1 to 4 cm, where `is_bed` allows it; about one in six is reddish.
fn scatter_stone(
    dice: &mut Dice,
    texels: usize,
    colours: &mut [Colour],
    is_bed: impl Fn(usize, usize) -> bool,
) {
    let (column, row) = (dice.within(0.0, texels as f64), dice.within(0.0, texels as f64));
    if !is_bed(column as usize, row as usize) {
        return;
    }
    let grey = dice.within(80.0, 190.0);
    let warmth: Colour = if dice.chance(0.17) { [1.15, 0.62, 0.5] } else { [1.02, 0.97, 0.9] };
    let (along, across) = (dice.within(1.2, 3.2), dice.within(0.8, 1.8));
    let (sin, cos) = dice.within(0.0, std::f64::consts::PI).sin_cos();
    for dy in -4..=4_i32 {
        for dx in -4..=4_i32 {
            let (x, y) = (f64::from(dx), f64::from(dy));
            let (a, b) = ((x * cos + y * sin) / along, (y * cos - x * sin) / across);
            if a * a + b * b < 1.0 {
                let wrap = |at: f64, by: i32| (at as i64 + i64::from(by)).rem_euclid(texels as i64) as usize;
                let rounded = 1.0 - 0.25 * (a * a + b * b);
                colours[wrap(row, dy) * texels + wrap(column, dx)] = warmth.map(|part| grey * part * rounded);
            }
        }
    }
}

/// A rectangle on the wall in metres: left, bottom, right, top; u runs to the right from the middle.
#[derive(Clone, Copy)]
struct Patch([f64; 4]);

impl Patch {
    fn contains(self, u: f64, v: f64) -> bool {
        let Self([left, bottom, right, top]) = self;
        (left..right).contains(&u) && (bottom..top).contains(&v)
    }
}

fn wall(dice: &mut Dice) -> Texture {
    let clouds = Clouds::new(dice.seed());
    let side = if dice.chance(0.5) { 1.0 } else { -1.0 };
    let window_u = side * dice.within(0.3, 1.2);
    let window_v = dice.within(1.35, 1.7);
    let window = Patch([window_u - 0.45, window_v, window_u + 0.45, window_v + dice.within(0.7, 1.0)]);
    let bricks_u = -side * dice.within(0.9, 1.6);
    let bricks_v = dice.within(1.1, 1.5);
    let bricks = Patch([bricks_u - 0.7, bricks_v, bricks_u + 0.7, bricks_v + dice.within(0.9, 1.2)]);
    let pane = dice.tinted([196.0, 206.0, 222.0], 10.0);
    let brick = dice.tinted([152.0, 74.0, 62.0], 8.0);
    let dark = dice.within(14.0, 26.0);
    let (width, height) = (1_usize << WALL_LOG2.0, 1_usize << WALL_LOG2.1);
    Texture::paint(WALL_LOG2.0, WALL_LOG2.1, |column, row| {
        let metres = |i: usize, n: usize| {
            let m = i as f64 / WALL_TEXELS_PER_M;
            if i > n / 2 && n == width { m - n as f64 / WALL_TEXELS_PER_M } else { m }
        };
        let (u, v) = (metres(column, width), metres(row, height));
        let cloud = clouds.at(column as f64 / width as f64, row as f64 / height as f64, 16, 4);
        if window.contains(u, v) {
            pane.map(|level| level + 4.0 * cloud)
        } else if bricks.contains(u, v) {
            brick_at(u, v, brick, cloud, dark)
        } else {
            [dark, dark, dark + 4.0].map(|level| level + 8.0 * cloud)
        }
    })
}

/// Courses of 7.5 cm with 1 cm of dark joint, every other one moved by half a brick of 22 cm.
fn brick_at(u: f64, v: f64, brick: Colour, cloud: f64, joint: f64) -> Colour {
    let course = (v / 0.075).floor();
    let along = (u + 0.11 * course.rem_euclid(2.0)).rem_euclid(0.22);
    if v.rem_euclid(0.075) < 0.011 || along < 0.011 {
        return [joint; 3].map(|level| level * 1.6);
    }
    let kiln = 12.0 * ((u / 0.22).floor() * 2.3 + course * 1.7).sin();
    brick.map(|level| level + kiln + 8.0 * cloud)
}
