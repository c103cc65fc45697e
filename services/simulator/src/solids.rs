//! Boxes and plates.

use crate::vector::Vec3;
use crate::world::{Colour, Face, Layer, Light};

/// A box that stands on the ground: `size_m` along its own x, y and z, turned by `yaw_rad`, the middle of its
/// bottom at `foot`. `colour_of` gives each face's colour in white light from its outward normal.
pub(crate) fn standing_box(
    foot: Vec3,
    size_m: Vec3,
    yaw_rad: f64,
    light: &Light,
    colour_of: impl Fn(Vec3) -> Colour,
) -> Vec<Face> {
    let corner = |sx: f64, sy: f64, z: f64| {
        foot + Vec3::new(sx * size_m.x / 2.0, sy * size_m.y / 2.0, z * size_m.z).turned(yaw_rad)
    };
    let ring = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let mut faces: Vec<Vec<Vec3>> = (0..4)
        .map(|i| {
            let ((ax, ay), (bx, by)) = (ring[i], ring[(i + 1) % 4]);
            vec![corner(ax, ay, 0.0), corner(bx, by, 0.0), corner(bx, by, 1.0), corner(ax, ay, 1.0)]
        })
        .collect();
    faces.push(ring.map(|(x, y)| corner(x, y, 1.0)).to_vec());
    faces
        .into_iter()
        .map(|corners| {
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalised();
            let colour = light.shade(colour_of(normal), normal);
            Face { corners, normal, colour, layer: Layer::Surface }
        })
        .collect()
}

/// A flat board that faces back along the x axis, turned by `yaw_rad`; its pattern is given in metres to the right
/// and up from `centre`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Board {
    pub(crate) centre: Vec3,
    pub(crate) yaw_rad: f64,
}

impl Board {
    /// A convex polygon on the board; `layer` says whether it is the board itself or paint on it.
    pub(crate) fn face(self, outline: &[[f64; 2]], colour: Colour, layer: Layer, light: &Light) -> Face {
        let normal = Vec3::new(-1.0, 0.0, 0.0).turned(self.yaw_rad);
        let right = Vec3::new(0.0, -1.0, 0.0).turned(self.yaw_rad);
        let corners =
            outline.iter().map(|&[u, v]| self.centre + right * u + Vec3::new(0.0, 0.0, v)).collect();
        Face { corners, normal, colour: light.shade(colour, normal), layer }
    }
}

/// The corners of a rectangle around (`u`, `v`), metres.
pub(crate) fn rectangle([u, v]: [f64; 2], [width, height]: [f64; 2]) -> [[f64; 2]; 4] {
    let (w, h) = (width / 2.0, height / 2.0);
    [[u - w, v - h], [u + w, v - h], [u + w, v + h], [u - w, v + h]]
}
