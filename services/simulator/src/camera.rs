//! The pinhole camera.

use vision::SizePx;

use crate::vector::Vec3;

/// What stands nearer than this to the image plane is not drawn, metres.
pub(crate) const NEAR_M: f64 = 0.05;

/// A pinhole without distortion: square pixels, corner origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// The picture's size.
    pub size: SizePx,
    /// Focal length in pixels, the same along x and y.
    pub focal_px: f64,
    /// Where the optical axis meets the picture, frame pixels (x, y).
    pub principal_px: [f64; 2],
}

impl Intrinsics {
    /// A horizontal field of view of 60°, the optical axis through the picture's centre.
    pub(crate) fn of_size(size: SizePx) -> Self {
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        let focal_px = width / 2.0 / (std::f64::consts::PI / 6.0).tan();
        Self { size, focal_px, principal_px: [width / 2.0, height / 2.0] }
    }
}

/// Where the camera is and where it looks: turned by yaw about z, then pitch about y (positive: down), then roll
/// about x, as REP-103 has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pose {
    pub(crate) position: Vec3,
    pub(crate) yaw_rad: f64,
    pub(crate) pitch_rad: f64,
    pub(crate) roll_rad: f64,
}

/// A camera at its place in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) intrinsics: Intrinsics,
    pub(crate) position: Vec3,
    forward: Vec3,
    left: Vec3,
    up: Vec3,
}

impl Camera {
    pub(crate) fn new(intrinsics: Intrinsics, pose: Pose) -> Self {
        let (sin_pitch, cos_pitch) = pose.pitch_rad.sin_cos();
        let (sin_roll, cos_roll) = pose.roll_rad.sin_cos();
        let axis = |x, y, z| Vec3::new(x, y, z).turned(pose.yaw_rad);
        Self {
            intrinsics,
            position: pose.position,
            forward: axis(cos_pitch, 0.0, -sin_pitch),
            left: axis(sin_pitch * sin_roll, cos_roll, cos_pitch * sin_roll),
            up: axis(sin_pitch * cos_roll, -sin_roll, cos_pitch * cos_roll),
        }
    }

    /// Distance along the optical axis, metres.
    pub(crate) fn depth_m(&self, point: Vec3) -> f64 {
        (point - self.position).dot(self.forward)
    }

    /// The pixel of a point with a positive depth.
    pub(crate) fn pixel_from_world(&self, point: Vec3) -> [f64; 2] {
        let offset = point - self.position;
        let Intrinsics { focal_px, principal_px: [cx, cy], .. } = self.intrinsics;
        let scale = focal_px / offset.dot(self.forward);
        [cx - offset.dot(self.left) * scale, cy - offset.dot(self.up) * scale]
    }

    /// The direction that a pixel looks into, one unit long along the optical axis.
    pub(crate) fn ray(&self, pixel: [f64; 2]) -> Vec3 {
        let Intrinsics { focal_px, principal_px: [cx, cy], .. } = self.intrinsics;
        self.forward - self.left * ((pixel[0] - cx) / focal_px) - self.up * ((pixel[1] - cy) / focal_px)
    }

    /// Range in the ground plane and bearing from the optical axis, positive to the left.
    pub(crate) fn range_and_bearing(&self, point: Vec3) -> (f64, f64) {
        let offset = point - self.position;
        let heading = self.forward.y.atan2(self.forward.x);
        let turn = offset.y.atan2(offset.x) - heading;
        let bearing_rad =
            (turn + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        (offset.x.hypot(offset.y), bearing_rad)
    }

    /// The polygon on the picture that a polygon in the world makes, cut off where it passes the camera.
    pub(crate) fn polygon_from_world(&self, points: &[Vec3]) -> Vec<[f64; 2]> {
        let mut polygon = Vec::with_capacity(points.len() + 1);
        for (i, &to) in points.iter().enumerate() {
            let from = points[(i + points.len() - 1) % points.len()];
            let (before, after) = (self.depth_m(from) - NEAR_M, self.depth_m(to) - NEAR_M);
            if (before > 0.0) != (after > 0.0) {
                let crossing = from + (to - from) * (before / (before - after));
                polygon.push(self.pixel_from_world(crossing));
            }
            if after > 0.0 {
                polygon.push(self.pixel_from_world(to));
            }
        }
        polygon
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(pose: Pose) -> Camera {
        Camera::new(Intrinsics::of_size(SizePx { width: 640, height: 480 }), pose)
    }

    #[test]
    fn the_optical_axis_meets_the_centre_and_left_is_left() {
        let camera = camera(Pose { position: Vec3::new(1.0, 2.0, 0.5), ..Pose::default() });
        assert_eq!(camera.pixel_from_world(Vec3::new(5.0, 2.0, 0.5)), [320.0, 240.0]);
        let [x, y] = camera.pixel_from_world(Vec3::new(5.0, 3.0, 0.0));
        assert!(x < 320.0 && y > 240.0);
        let (range_m, bearing_rad) = camera.range_and_bearing(Vec3::new(4.0, 6.0, 9.0));
        assert!((range_m - 5.0).abs() < 1e-12 && (bearing_rad - (4.0_f64).atan2(3.0)).abs() < 1e-12);
    }

    #[test]
    fn projecting_a_ray_leads_back_to_its_pixel() {
        let position = Vec3::new(0.3, -0.2, 1.1);
        let camera = camera(Pose { position, yaw_rad: 0.3, pitch_rad: 0.1, roll_rad: -0.2 });
        for pixel in [[0.0, 0.0], [320.0, 240.0], [601.5, 77.25]] {
            let [x, y] = camera.pixel_from_world(position + camera.ray(pixel) * 3.0);
            assert!((x - pixel[0]).abs() < 1e-9 && (y - pixel[1]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_positive_pitch_looks_down() {
        let camera = camera(Pose { pitch_rad: 0.1, ..Pose::default() });
        assert!(camera.pixel_from_world(Vec3::new(10.0, 0.0, 0.0))[1] < 240.0);
    }

    #[test]
    fn a_polygon_that_passes_the_camera_is_cut_before_it() {
        let camera = camera(Pose { position: Vec3::new(0.0, 0.0, 1.0), ..Pose::default() });
        let floor = [[-5.0, -1.0], [5.0, -1.0], [5.0, 1.0], [-5.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let polygon = camera.polygon_from_world(&floor);
        assert_eq!(polygon.len(), 4);
        assert!(polygon.iter().all(|[x, y]| x.is_finite() && *y > 240.0));
        assert!(camera.polygon_from_world(&floor.map(|p| p - Vec3::new(9.0, 0.0, 0.0))).is_empty());
    }
}
