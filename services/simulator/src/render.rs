//! From a world and a moment to a picture.

pub(crate) mod canvas;
pub(crate) mod coverage;
mod film;
pub(crate) mod planes;
mod sensor;
mod sprites;

use canvas::Canvas;
pub(crate) use film::Film;
use sensor::Sensor;
use sprites::Brush;

use crate::camera::{Camera, NEAR_M};
use crate::world::{Item, World};

/// A thing that moves by less than this during the exposure is drawn once, px.
const SHARP_PX: f64 = 0.4;
/// The most poses over which the exposure of a thing is averaged.
const MOST_POSES: usize = 5;

/// The camera during one exposure: at its start, middle and end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exposure<'a> {
    /// The pose in the middle, for which truth is given.
    pub(crate) middle: &'a Camera,
    /// Poses at [`MOST_POSES`] moments spread evenly over the exposure.
    pub(crate) moments: &'a [Camera; MOST_POSES],
    /// Gain of R, G and B.
    pub(crate) gain: [f64; 3],
    /// Number of the frame, which selects its noise.
    pub(crate) index: u64,
    /// What a film does to it.
    pub(crate) film: Option<Film>,
}

/// Draws worlds.
#[derive(Debug)]
pub(crate) struct Renderer {
    sensor: Sensor,
    brush: Brush,
}

impl Renderer {
    pub(crate) fn new(seed: u64) -> Self {
        Self { sensor: Sensor::new(seed), brush: Brush::default() }
    }

    pub(crate) fn render(&mut self, world: &World, exposure: Exposure<'_>) -> Canvas {
        let mut canvas = Canvas::new(exposure.middle.intrinsics.size);
        planes::draw(world, exposure.middle, &mut canvas);
        for shadow in &world.shadows {
            self.brush.draw_shadow(shadow, exposure.middle, &mut canvas);
        }
        sensor::shake(shake_px(exposure), &mut canvas);
        for item in from_far_to_near(world, exposure.middle) {
            let poses = poses_for(item, exposure);
            self.brush.draw_item(item, &poses, &mut canvas);
        }
        let Some(film) = exposure.film else {
            self.sensor.expose(exposure.gain, sensor::FINE_GRAIN_Q2, exposure.index, &mut canvas);
            return canvas;
        };
        film.focus(&mut canvas);
        self.sensor.expose(exposure.gain, film.grain_q2, exposure.index, &mut canvas);
        film.developed(canvas)
    }
}

/// Number of moments at which a camera's pose is wanted for one exposure.
pub(crate) const MOMENTS: usize = MOST_POSES;

/// How far the picture of something far away moves during the exposure.
fn shake_px(exposure: Exposure<'_>) -> [f64; 2] {
    let far = exposure.middle.position + exposure.middle.ray(exposure.middle.intrinsics.principal_px) * 1e6;
    motion_px(far, exposure)
}

/// The motion of a point's picture during the exposure; the moments span all but one step of it.
fn motion_px(point: crate::vector::Vec3, exposure: Exposure<'_>) -> [f64; 2] {
    let [first, .., last] = exposure.moments;
    if first.depth_m(point) < NEAR_M || last.depth_m(point) < NEAR_M {
        return [0.0; 2];
    }
    let (a, b) = (first.pixel_from_world(point), last.pixel_from_world(point));
    let whole = MOST_POSES as f64 / (MOST_POSES - 1) as f64;
    [(b[0] - a[0]) * whole, (b[1] - a[1]) * whole]
}

fn poses_for(item: &Item, exposure: Exposure<'_>) -> Vec<Camera> {
    let [x, y] = motion_px(item.centre, exposure);
    if x.hypot(y) < SHARP_PX { vec![*exposure.middle] } else { exposure.moments.to_vec() }
}

fn from_far_to_near<'a>(world: &'a World, camera: &Camera) -> Vec<&'a Item> {
    let mut items: Vec<&Item> =
        world.items.iter().filter(|item| camera.depth_m(item.centre) > NEAR_M).collect();
    items.sort_by(|a, b| camera.depth_m(b.centre).total_cmp(&camera.depth_m(a.centre)));
    items
}
