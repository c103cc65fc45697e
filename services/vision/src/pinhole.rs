//! Where an object is, seen from the camera: bearing and range from its place and size on the picture.
//!
//! The camera is taken for level and free of distortion, so a column of the picture is a direction in the ground plane.

use crate::geometry::{PointPx, SizePx};
use crate::landmark::{Landmark, LandmarkSet, ShapeClass};
use crate::outcome::{LandmarkOutcome, Outcome, Sighting};

/// An outline that comes this near to the border of the picture may go on beyond it.
const BORDER_PX: f32 = 1.5;

/// An ideal camera: no distortion, square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// Size of its pictures.
    pub size: SizePx,
    /// Focal length in pixels.
    pub focal_px: f64,
    /// Column of the optical axis, corner origin.
    pub centre_x_px: f64,
    /// Row of the optical axis, corner origin.
    pub centre_y_px: f64,
}

/// Where an object is in the ground plane, seen from the optical centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Direction of its centre, rad, positive to the left of the optical axis; `None` for a miss or without a camera.
    pub bearing_rad: Option<f32>,
    /// Distance to its centre, m; `None` also where its size is unknown, or a part of it lies outside the picture.
    pub range_m: Option<f32>,
}

/// The place of every entry of an outcome, in its order. `camera` must be that of the pictures, in their size.
#[must_use]
pub fn places(outcome: &Outcome, set: &LandmarkSet, camera: Option<&Pinhole>) -> Vec<Place> {
    let camera = camera.filter(|camera| camera.size == outcome.frame_size);
    let landmark = |one: &LandmarkOutcome| set.landmarks.iter().find(|known| known.digest == one.digest);
    let place = |one: &LandmarkOutcome| match (camera, &one.result) {
        (Some(camera), Ok(sighting)) => camera.place(sighting, landmark(one).map(AsRef::as_ref)),
        _ => Place::default(),
    };
    outcome.landmarks.iter().map(place).collect()
}

impl Pinhole {
    fn place(&self, sighting: &Sighting, landmark: Option<&Landmark>) -> Place {
        let bearing_rad = self.bearing_rad(sighting.centroid);
        let depth_m = landmark.and_then(|landmark| self.depth_m(sighting, landmark));
        let range_m = depth_m.map(|depth_m| (depth_m / bearing_rad.cos()) as f32);
        Place { bearing_rad: Some(bearing_rad as f32), range_m }
    }

    /// Direction of a column in the ground plane, rad, positive to the left of the optical axis (REP-103).
    #[must_use]
    pub fn bearing_rad(&self, point: PointPx) -> f64 {
        ((self.centre_x_px - f64::from(point.x)) / self.focal_px).atan()
    }

    /// Distance of the object's centre along the optical axis: focal length × true length / apparent length.
    fn depth_m(&self, sighting: &Sighting, landmark: &Landmark) -> Option<f64> {
        let size_m = f64::from(landmark.size_m?);
        let apparent_px = self.apparent_px(sighting, landmark.shape)?;
        let face_m = self.focal_px * size_m / apparent_px;
        // A block shows its nearest face, and its centre lies half an edge behind that.
        let behind_m = if landmark.shape == ShapeClass::Block { size_m / 2.0 } else { 0.0 };
        (face_m.is_finite() && face_m > 0.0).then_some(face_m + behind_m)
    }

    /// How long that appears on the picture which `size_m` tells, px: a sign's width, a block's edge. It comes from the
    /// area, the most exact of all measures, where the shape ties one to the other.
    fn apparent_px(&self, sighting: &Sighting, shape: ShapeClass) -> Option<f64> {
        let extent = whole_extent(&sighting.outline, self.size)?;
        let (width_px, area_px2) = (extent.width_px(), f64::from(sighting.area_px2));
        let apparent_px = match shape {
            ShapeClass::Octagon => (area_px2 / (2.0 * (std::f64::consts::SQRT_2 - 1.0))).sqrt(),
            ShapeClass::Circle => (area_px2 * std::f64::consts::FRAC_1_PI * 4.0).sqrt(),
            ShapeClass::Triangle => (area_px2 * 4.0 / 3f64.sqrt()).sqrt(),
            ShapeClass::Rectangle | ShapeClass::Any => (area_px2 * width_px / extent.height_px()).sqrt(),
            ShapeClass::Block => edge_px(area_px2, width_px, self.slope(&extent)),
        };
        (apparent_px.is_finite() && apparent_px > 0.0).then_some(apparent_px)
    }

    /// How steeply the nearest horizontal edge of an object is looked at from above or below: tangent, 0 at the horizon.
    fn slope(&self, extent: &Extent) -> f64 {
        let below_px = f64::from(extent.top) - self.centre_y_px;
        let above_px = self.centre_y_px - f64::from(extent.bottom);
        below_px.max(above_px).max(0.0) / self.focal_px
    }
}

/// Edge of a cube whose silhouette has this area and width, px. A cube of edge s, turned so that it is w·s wide, shows
/// side faces of w·s² and, looked at with slope t, a top of t·s²; so area = s·width + t·s², however it is turned.
fn edge_px(area_px2: f64, width_px: f64, slope: f64) -> f64 {
    2.0 * area_px2 / (width_px + (width_px * width_px + 4.0 * area_px2 * slope).sqrt())
}

/// What an outline reaches to, frame pixels.
struct Extent {
    left: f32,
    right: f32,
    top: f32,
    bottom: f32,
}

impl Extent {
    fn width_px(&self) -> f64 {
        f64::from(self.right - self.left)
    }

    fn height_px(&self) -> f64 {
        f64::from(self.bottom - self.top)
    }
}

/// The extent of an outline that lies wholly inside the picture.
fn whole_extent(outline: &[PointPx], frame: SizePx) -> Option<Extent> {
    let span = |coordinate: fn(&PointPx) -> f32| {
        let ends = (f32::INFINITY, f32::NEG_INFINITY);
        outline.iter().map(coordinate).fold(ends, |(low, high), at| (low.min(at), high.max(at)))
    };
    let ((left, right), (top, bottom)) = (span(|point| point.x), span(|point| point.y));
    let inside = left > BORDER_PX
        && top > BORDER_PX
        && right < frame.width as f32 - BORDER_PX
        && bottom < frame.height as f32 - BORDER_PX;
    (inside && right > left && bottom > top).then_some(Extent { left, right, top, bottom })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::landmark::{ColorStats, Digest, WindowPx};
    use crate::outcome::Miss;

    const CAMERA: Pinhole = Pinhole {
        size: SizePx { width: 640, height: 480 },
        focal_px: 500.0,
        centre_x_px: 320.0,
        centre_y_px: 240.0,
    };

    fn landmark(shape: ShapeClass, size_m: Option<f32>) -> Landmark {
        Landmark {
            id: "sign".into(),
            revision: 1,
            window_px: WindowPx::square(12),
            shades: vec![ColorStats::default()],
            tolerance: ColorStats::default(),
            shape,
            size_m,
            digest: Digest::default(),
        }
    }

    fn rectangle(left: f32, top: f32, width: f32, height: f32) -> Sighting {
        let (right, bottom) = (left + width, top + height);
        Sighting {
            centroid: PointPx::new(left + width / 2.0, top + height / 2.0),
            area_px2: width * height,
            outline: [(left, top), (right, top), (right, bottom), (left, bottom)]
                .map(|(x, y)| PointPx::new(x, y))
                .to_vec(),
            ..Sighting::default()
        }
    }

    proptest! {
        #[test]
        fn a_sign_is_where_it_was_put(depth_m in 2.0f32..40.0, left_m in -1.0f32..1.0, wide_m in 0.3f32..1.0, aspect in 0.5f32..2.0) {
            let scale = 500.0 / depth_m;
            let (width, height) = (wide_m * scale, wide_m * aspect * scale);
            prop_assume!(width < 200.0 && height < 200.0);
            let centre_x = 320.0 - left_m * scale;
            prop_assume!(centre_x - width / 2.0 > 2.0 && centre_x + width / 2.0 < 638.0);
            let seen = rectangle(centre_x - width / 2.0, 240.0 - height / 2.0, width, height);
            let place = CAMERA.place(&seen, Some(&landmark(ShapeClass::Rectangle, Some(wide_m))));
            prop_assert!((place.bearing_rad.unwrap() - left_m.atan2(depth_m)).abs() < 1e-4);
            prop_assert!((place.range_m.unwrap() / left_m.hypot(depth_m) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn areas_of_other_shapes_give_their_width() {
        let width = 60.0f64;
        for (shape, area) in [
            (ShapeClass::Octagon, 0.828_427 * width * width),
            (ShapeClass::Circle, std::f64::consts::FRAC_PI_4 * width * width),
            (ShapeClass::Triangle, 0.433_013 * width * width),
        ] {
            let seen = Sighting { area_px2: area as f32, ..rectangle(290.0, 210.0, 60.0, 55.0) };
            let range_m = CAMERA.place(&seen, Some(&landmark(shape, Some(0.6)))).range_m.unwrap();
            assert!((range_m - 5.0).abs() < 1e-3, "{shape:?}: {range_m}");
        }
    }

    #[test]
    fn a_block_at_the_horizon_is_ranged_by_its_height_to_its_centre() {
        let turned = rectangle(285.0, 220.0, 70.0, 50.0);
        let range_m = CAMERA.place(&turned, Some(&landmark(ShapeClass::Block, Some(0.4)))).range_m.unwrap();
        assert!((range_m - 4.2).abs() < 1e-3, "{range_m}");
    }

    #[test]
    fn the_top_of_a_block_does_not_bring_it_nearer() {
        let (edge, wide, slope) = (50.0, 1.3, 0.3);
        let area = edge * edge * (wide + slope);
        assert!((edge_px(area, wide * edge, slope) - edge).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_known_is_absent() {
        let known = landmark(ShapeClass::Rectangle, Some(0.5));
        let place = |seen: &Sighting, landmark: &Landmark| CAMERA.place(seen, Some(landmark));
        let cut = rectangle(0.0, 200.0, 40.0, 40.0);
        assert!(place(&cut, &known).bearing_rad.is_some() && place(&cut, &known).range_m.is_none());
        let sizeless = landmark(ShapeClass::Rectangle, None);
        assert_eq!(place(&rectangle(300.0, 200.0, 40.0, 40.0), &sizeless).range_m, None);
        assert_eq!(place(&Sighting::default(), &known).range_m, None, "no outline");
    }

    #[test]
    fn places_are_those_of_the_outcomes_own_camera_and_landmarks() {
        let entry = |result| LandmarkOutcome {
            landmark: "sign".into(),
            digest: Digest::default(),
            instance: 0,
            prediction: None,
            gate: None,
            result,
            innovation_px: None,
            adaptation: None,
        };
        let seen = rectangle(300.0, 220.0, 40.0, 40.0);
        let outcome = Outcome {
            frame_size: CAMERA.size,
            landmarks: vec![entry(Err(Miss::TooSmall)), entry(Ok(seen))],
            ..Outcome::default()
        };
        let landmarks = vec![Arc::new(landmark(ShapeClass::Rectangle, Some(0.4)))];
        let set = LandmarkSet { landmarks, ..LandmarkSet::default() };
        let found = places(&outcome, &set, Some(&CAMERA));
        assert_eq!(found[0], Place::default());
        assert_eq!(found[1].range_m, Some(5.0));
        assert_eq!(places(&outcome, &LandmarkSet::default(), Some(&CAMERA))[1].range_m, None);
        let other = Pinhole { size: SizePx { width: 320, height: 240 }, ..CAMERA };
        assert_eq!(places(&outcome, &set, Some(&other)), [Place::default(); 2]);
        assert_eq!(places(&outcome, &set, None), [Place::default(); 2]);
    }
}
