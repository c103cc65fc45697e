//! The ground and what closes the view: textured planes in exact perspective.

use std::ops::Range;

use vision::SizePx;

use super::canvas::Canvas;
use crate::camera::Camera;
use crate::texture::{TexelPosition, Texture};
use crate::world::{BackdropPlace, World};

/// Perspective is exact at the ends of spans of this many pixels and linear between them.
const SPAN_PX: usize = 16;

/// A texture laid over a plane.
#[derive(Debug)]
pub(crate) struct Plane {
    pub(crate) texture: Texture,
    pub(crate) texels_per_m: f64,
}

/// A function of the pixel that is linear: `a · x + b · y + c`.
type Linear = [f64; 3];

fn value(f: Linear, x: f64, y: f64) -> f64 {
    f[0] * x + f[1] * y + f[2]
}

fn combine(a: Linear, p: f64, b: Linear, q: f64) -> Linear {
    [a[0] * p + b[0] * q, a[1] * p + b[1] * q, a[2] * p + b[2] * q]
}

/// Texture position (u, v) = (U / W, V / W) of a pixel, in texels.
#[derive(Clone, Copy, Debug)]
struct Homography {
    u: Linear,
    v: Linear,
    w: Linear,
}

impl Homography {
    fn texels(&self, x: f64, y: f64) -> [f64; 2] {
        let scale = 1.0 / value(self.w, x, y);
        [value(self.u, x, y) * scale, value(self.v, x, y) * scale]
    }

    /// The mipmap level whose texels are about as large as a pixel, by area.
    fn level(&self, x: f64, y: f64, coarsest: u32) -> u32 {
        let [u, v] = self.texels(x, y);
        let [u_right, v_right] = self.texels(x + 1.0, y);
        let [u_below, v_below] = self.texels(x, y + 1.0);
        let footprint = ((u_right - u) * (v_below - v) - (u_below - u) * (v_right - v)).abs();
        ((footprint.max(1.0) as u64).ilog2().div_ceil(2)).min(coarsest)
    }

    fn draw_row(&self, texture: &Texture, y: usize, columns: Range<usize>, rgb: &mut [u8]) {
        let centre_y = y as f64 + 0.5;
        for start in columns.clone().step_by(SPAN_PX) {
            let end = (start + SPAN_PX).min(columns.end);
            let length = (end - start) as f64;
            let [u0, v0] = self.texels(start as f64 + 0.5, centre_y);
            let [u1, v1] = self.texels(end as f64 + 0.5, centre_y);
            let level = self.level(start as f64 + length / 2.0, centre_y, texture.coarsest());
            let step = TexelPosition::from_texels((u1 - u0) / length, (v1 - v0) / length);
            let span = &mut rgb[3 * (start - columns.start)..3 * (end - columns.start)];
            texture.sample_span(level, TexelPosition::from_texels(u0, v0), step, span);
        }
    }
}

/// The two planes as one camera sees them, and the line where they meet.
struct View<'a> {
    ground: (&'a Texture, Homography),
    backdrop: (&'a Texture, Homography),
    /// Positive where a pixel shows the backdrop, in pixels from the line where they meet.
    above_ground_px: Linear,
}

impl<'a> View<'a> {
    fn new(world: &'a World, camera: &Camera) -> Self {
        let [dx, dy, dz] = ray_components(camera);
        let at = camera.position;
        let ahead_m = match world.backdrop_place {
            BackdropPlace::Wall(x_m) => x_m - at.x,
            BackdropPlace::Sky(distance_m) => distance_m,
        };
        let scaled = |u: Linear, v: Linear, w: Linear, scale: f64| Homography {
            u: u.map(|factor| factor * scale),
            v: v.map(|factor| factor * scale),
            w,
        };
        // Ground, z = 0: X = (Cx·dz − Cz·dx) / dz. Backdrop, x = Cx + ahead: Y = (Cy·dx + ahead·dy) / dx.
        let ground =
            scaled(combine(dz, at.x, dx, -at.z), combine(dz, at.y, dy, -at.z), dz, world.ground.texels_per_m);
        let height = combine(dx, at.z, dz, ahead_m);
        let backdrop = scaled(combine(dx, -at.y, dy, -ahead_m), height, dx, world.backdrop.texels_per_m);
        let gradient = height[0].hypot(height[1]);
        Self {
            ground: (&world.ground.texture, ground),
            backdrop: (&world.backdrop.texture, backdrop),
            above_ground_px: height.map(|factor| factor / gradient),
        }
    }

    /// The columns of a row that the line between the planes passes, and whether the backdrop is left of them.
    fn meeting(&self, y: usize, width: usize) -> (Range<usize>, bool) {
        let [slope, ..] = self.above_ground_px;
        let at_left = value(self.above_ground_px, 0.5, y as f64 + 0.5);
        let column = |height_px: f64| ((height_px - at_left) / slope).clamp(-1.0, width as f64 + 1.0);
        if slope.abs() < 1e-12 {
            let mixed = if at_left.abs() < 0.5 { 0..width } else { width..width };
            return (mixed, at_left > 0.0);
        }
        let (a, b) = (column(-0.5), column(0.5));
        let start = (a.min(b).floor() as i64).clamp(0, width as i64) as usize;
        let end = (a.max(b).ceil() as i64 + 1).clamp(0, width as i64) as usize;
        (start..end.max(start), slope < 0.0)
    }

    fn draw_row(&self, y: usize, row: &mut [u8], spare: &mut [u8]) {
        let width = row.len() / 3;
        let (mixed, backdrop_left) = self.meeting(y, width);
        let (left, right) =
            if backdrop_left { (&self.backdrop, &self.ground) } else { (&self.ground, &self.backdrop) };
        left.1.draw_row(left.0, y, 0..mixed.start, &mut row[..3 * mixed.start]);
        right.1.draw_row(right.0, y, mixed.end..width, &mut row[3 * mixed.end..]);
        if mixed.is_empty() {
            return;
        }
        let span = &mut row[3 * mixed.start..3 * mixed.end];
        let spare = &mut spare[..span.len()];
        self.ground.1.draw_row(self.ground.0, y, mixed.clone(), span);
        self.backdrop.1.draw_row(self.backdrop.0, y, mixed.clone(), spare);
        for ((ground, backdrop), x) in span.chunks_exact_mut(3).zip(spare.chunks_exact(3)).zip(mixed) {
            let height_px = value(self.above_ground_px, x as f64 + 0.5, y as f64 + 0.5);
            let weight = ((height_px + 0.5).clamp(0.0, 1.0) * 256.0) as u32;
            for (below, above) in ground.iter_mut().zip(backdrop) {
                *below = ((u32::from(*below) * (256 - weight) + u32::from(*above) * weight) >> 8) as u8;
            }
        }
    }
}

/// The x, y and z components of a pixel's ray as functions of the pixel.
fn ray_components(camera: &Camera) -> [Linear; 3] {
    let origin = camera.ray([0.0, 0.0]);
    let along_x = camera.ray([1.0, 0.0]) - origin;
    let along_y = camera.ray([0.0, 1.0]) - origin;
    [[along_x.x, along_y.x, origin.x], [along_x.y, along_y.y, origin.y], [along_x.z, along_y.z, origin.z]]
}

/// Fills the whole picture with ground and backdrop.
pub(crate) fn draw(world: &World, camera: &Camera, canvas: &mut Canvas) {
    let SizePx { width, .. } = camera.intrinsics.size;
    let view = View::new(world, camera);
    let mut spare = vec![0; 3 * width as usize];
    for (y, row) in canvas.rows_mut().enumerate() {
        view.draw_row(y, row, &mut spare);
    }
}
