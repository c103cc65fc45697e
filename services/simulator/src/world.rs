//! What a scene consists of: two textured planes, shadows on the ground, and things that stand on it.

use crate::camera::{Camera, NEAR_M};
use crate::drive::Drive;
use crate::polygon::{Point, hull};
use crate::render::planes::Plane;
use crate::vector::Vec3;

/// R, G, B in 8-bit levels.
pub(crate) type Colour = [f64; 3];

/// Corners of the polygon that stands for a ball's outline.
const BALL_CORNERS: usize = 18;

/// Everything that can be seen, and the way of the vehicle that sees it.
#[derive(Debug)]
pub(crate) struct World {
    /// The ground, z = 0: texture u along x, v along y.
    pub(crate) ground: Plane,
    /// What closes the view: texture u to the right, v upwards.
    pub(crate) backdrop: Plane,
    /// Where the backdrop stands.
    pub(crate) backdrop_place: BackdropPlace,
    /// Shadows on the ground.
    pub(crate) shadows: Vec<Shadow>,
    /// What stands on the ground.
    pub(crate) items: Vec<Item>,
    /// The vehicle's way.
    pub(crate) drive: Drive,
}

/// Where the backdrop's plane, which is perpendicular to the x axis, stands.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BackdropPlace {
    /// A wall at this x, metres.
    Wall(f64),
    /// A sky that always is this far ahead, metres.
    Sky(f64),
}

/// A polygon on the ground that receives less light.
#[derive(Clone, Debug)]
pub(crate) struct Shadow {
    pub(crate) corners: Vec<Vec3>,
    /// Part of the light that is missing, 0..1.
    pub(crate) darkness: f64,
}

/// A thing in the world.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    /// Its name, for those that truth is kept of.
    pub(crate) name: Option<String>,
    /// Its centre, metres.
    pub(crate) centre: Vec3,
    pub(crate) body: Body,
}

/// The form of a thing.
#[derive(Clone, Debug)]
pub(crate) enum Body {
    /// A convex solid, or a plate, bounded by convex faces.
    Solid(Vec<Face>),
    /// A ball of one colour.
    Ball { radius_m: f64, colour: Colour },
}

/// Whether a face bounds the solid or lies on another face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layer {
    /// Part of the solid's surface.
    Surface,
    /// Painted on the faces before it.
    Paint,
}

/// A flat convex polygon of one colour, visible from the side to which its normal points.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    pub(crate) corners: Vec<Vec3>,
    pub(crate) normal: Vec3,
    pub(crate) colour: Colour,
    pub(crate) layer: Layer,
}

impl Face {
    pub(crate) fn is_seen_from(&self, position: Vec3) -> bool {
        self.normal.dot(position - self.corners[0]) > 0.0
    }
}

impl Item {
    /// The same, so much higher above the ground, metres.
    pub(crate) fn raised(mut self, height_m: f64) -> Self {
        let up = Vec3::new(0.0, 0.0, height_m);
        self.centre = self.centre + up;
        if let Body::Solid(faces) = &mut self.body {
            faces.iter_mut().flat_map(|face| &mut face.corners).for_each(|corner| *corner = *corner + up);
        }
        self
    }

    /// The convex outline on the picture, before the frame cuts it; empty when it is behind the camera.
    pub(crate) fn silhouette(&self, camera: &Camera) -> Vec<Point> {
        if camera.depth_m(self.centre) < NEAR_M {
            return Vec::new();
        }
        match &self.body {
            Body::Solid(faces) => hull(
                faces
                    .iter()
                    .filter(|face| face.layer == Layer::Surface && face.is_seen_from(camera.position))
                    .flat_map(|face| camera.polygon_from_world(&face.corners))
                    .collect(),
            ),
            Body::Ball { radius_m, .. } => self.ball_outline(camera, *radius_m),
        }
    }

    fn ball_outline(&self, camera: &Camera, radius_m: f64) -> Vec<Point> {
        let depth_m = camera.depth_m(self.centre);
        if depth_m < radius_m + NEAR_M {
            return Vec::new();
        }
        let [x, y] = camera.pixel_from_world(self.centre);
        let radius_px = camera.intrinsics.focal_px * radius_m / depth_m;
        (0..BALL_CORNERS)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / BALL_CORNERS as f64).sin_cos();
                [x + radius_px * cos, y + radius_px * sin]
            })
            .collect()
    }

    /// Whether this thing is drawn over `other`: things are drawn from far to near by their centres.
    pub(crate) fn hides(&self, other: &Self, camera: &Camera) -> bool {
        camera.depth_m(self.centre) < camera.depth_m(other.centre)
    }
}

/// The sun or the lamp.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    /// From the things to the light, one unit long, upwards.
    pub(crate) towards: Vec3,
    /// Part of the light that comes from everywhere.
    pub(crate) ambient: f64,
    /// How dark its shadows are, 0 for none.
    pub(crate) shadow_darkness: f64,
}

impl Light {
    /// `colour` as it looks on a surface with that normal.
    pub(crate) fn shade(&self, colour: Colour, normal: Vec3) -> Colour {
        let level = self.ambient + (1.0 - self.ambient) * normal.dot(self.towards).max(0.0);
        colour.map(|channel| (channel * level).min(255.0))
    }

    /// The shadow that `item` casts on the ground, with a penumbra of three steps.
    pub(crate) fn shadows_of(&self, item: &Item) -> Vec<Shadow> {
        let Body::Solid(faces) = &item.body else { return Vec::new() };
        if self.shadow_darkness <= 0.0 {
            return Vec::new();
        }
        let darkness = 1.0 - (1.0 - self.shadow_darkness).cbrt();
        [-0.03, 0.0, 0.03]
            .into_iter()
            .map(|turn| {
                let towards = self.towards.turned(turn);
                let on_ground =
                    |p: Vec3| [p.x - towards.x * p.z / towards.z, p.y - towards.y * p.z / towards.z];
                let outline =
                    hull(faces.iter().flat_map(|face| face.corners.iter().copied().map(on_ground)).collect());
                let corners = outline.into_iter().map(|[x, y]| Vec3::new(x, y, 0.0)).collect();
                Shadow { corners, darkness }
            })
            .collect()
    }
}
