//! Where everything really is on the picture.

use vision::SizePx;
use waymark_proto::v1;

use crate::camera::Camera;
use crate::polygon::{Moments, bounds, inside_frame, subtract};
use crate::world::{Item, World};

/// Pieces of less than this are not reported, px².
const LEAST_AREA_PX2: f64 = 1e-6;

/// One object of the scene as the camera sees it, in the middle of the exposure.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueObject {
    /// The object's name in the scene.
    pub object: String,
    /// Centre of the visible silhouette, frame pixels (x, y), corner origin.
    pub centroid_px: [f64; 2],
    /// Area of the visible silhouette: inside the frame and not covered by nearer things.
    pub area_px2: f64,
    /// Left, top, right and bottom of the visible silhouette, frame pixels.
    pub bbox_px: [f64; 4],
    /// The visible area as a part of the whole silhouette's, 0..1.
    pub visible: f64,
    /// Distance in the ground plane from the optical centre to the object's centre.
    pub range_m: f64,
    /// Direction in the ground plane from the optical axis, positive to the left.
    pub bearing_rad: f64,
}

impl From<&TrueObject> for v1::TrueObject {
    fn from(object: &TrueObject) -> Self {
        let [x_px, y_px] = object.centroid_px;
        let [left_px, top_px, right_px, bottom_px] = object.bbox_px;
        Self {
            object: object.object.clone(),
            x_px,
            y_px,
            area_px2: object.area_px2,
            left_px,
            top_px,
            right_px,
            bottom_px,
            visible: object.visible,
        }
    }
}

/// Every named object of which at least a piece is visible, in the order of the world's list.
pub(crate) fn observe(world: &World, camera: &Camera) -> Vec<TrueObject> {
    world
        .items
        .iter()
        .filter_map(|item| {
            let name = item.name.as_ref()?;
            observe_item(world, camera, item, name)
        })
        .collect()
}

fn observe_item(world: &World, camera: &Camera, item: &Item, name: &str) -> Option<TrueObject> {
    let SizePx { width, height } = camera.intrinsics.size;
    let silhouette = item.silhouette(camera);
    let whole_px2 = Moments::of(&silhouette).area_px2;
    let mut visible = vec![inside_frame(&silhouette, f64::from(width), f64::from(height))];
    for other in world.items.iter().filter(|other| other.hides(item, camera)) {
        if visible.is_empty() {
            break;
        }
        visible = subtract(visible, &other.silhouette(camera));
    }
    let moments = visible.iter().map(|piece| Moments::of(piece)).fold(Moments::default(), Moments::plus);
    if moments.area_px2 <= LEAST_AREA_PX2 {
        return None;
    }
    let (range_m, bearing_rad) = camera.range_and_bearing(item.centre);
    Some(TrueObject {
        object: name.to_owned(),
        centroid_px: moments.centroid(),
        area_px2: moments.area_px2,
        bbox_px: bounds(&visible.concat()),
        visible: moments.area_px2 / whole_px2,
        range_m,
        bearing_rad,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{SceneKind, SceneOptions};
    use crate::scene;
    use crate::vector::Vec3;
    use crate::world::{Body, Face, Layer};
    use crate::{Intrinsics, Simulator};

    /// Samples along each side of the box in which an object is looked for.
    const SAMPLES: u32 = 96;

    /// What a ray meets first among the drawn things: the slow, obvious way, which knows no polygons on the picture.
    fn first_hit<'a>(world: &'a World, camera: &Camera, pixel: [f64; 2]) -> Option<&'a Item> {
        let ray = camera.ray(pixel);
        world
            .items
            .iter()
            .filter(|item| camera.depth_m(item.centre) > crate::camera::NEAR_M && meets(item, camera, ray))
            .min_by(|a, b| camera.depth_m(a.centre).total_cmp(&camera.depth_m(b.centre)))
    }

    fn meets(item: &Item, camera: &Camera, ray: Vec3) -> bool {
        match &item.body {
            Body::Solid(faces) => faces
                .iter()
                .filter(|face| face.layer == Layer::Surface && face.is_seen_from(camera.position))
                .any(|face| ray_meets_face(camera.position, ray, face)),
            Body::Ball { radius_m, .. } => {
                let depth_m = camera.depth_m(item.centre);
                let at_depth = camera.position + ray * depth_m - item.centre;
                depth_m > *radius_m && at_depth.dot(at_depth) < radius_m * radius_m
            }
        }
    }

    fn ray_meets_face(origin: Vec3, ray: Vec3, face: &Face) -> bool {
        let distance = face.normal.dot(face.corners[0] - origin) / face.normal.dot(ray);
        let point = origin + ray * distance;
        let sides = face.corners.iter().enumerate().map(|(i, &a)| {
            let b = face.corners[(i + 1) % face.corners.len()];
            (b - a).cross(point - a).dot(face.normal)
        });
        let sides: Vec<f64> = sides.collect();
        distance > 0.0 && (sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0))
    }

    /// Area and centroid of a named object by counting rays within `around` (left, top, right, bottom).
    fn count(world: &World, camera: &Camera, name: &str, around: [f64; 4]) -> (f64, [f64; 2]) {
        let [left, top, right, bottom] = around;
        let step = [(right - left) / f64::from(SAMPLES), (bottom - top) / f64::from(SAMPLES)];
        let [mut hits, mut x, mut y] = [0.0; 3];
        for sample in 0..SAMPLES * SAMPLES {
            let pixel = [
                left + (f64::from(sample % SAMPLES) + 0.5) * step[0],
                top + (f64::from(sample / SAMPLES) + 0.5) * step[1],
            ];
            if first_hit(world, camera, pixel).is_some_and(|item| item.name.as_deref() == Some(name)) {
                hits += 1.0;
                x += pixel[0];
                y += pixel[1];
            }
        }
        (hits * step[0] * step[1], [x / hits, y / hits])
    }

    #[test]
    fn truth_agrees_with_counting_what_every_ray_meets() {
        let size = SizePx { width: 320, height: 240 };
        let mut compared = 0;
        for (kind, seeds) in
            [(SceneKind::Rink, 1..=4), (SceneKind::StopSign, 1..=3), (SceneKind::GreenSigns, 1..=1)]
        {
            for seed in seeds {
                let options = SceneOptions { size, seed, ..SceneOptions::new(kind) };
                let (world, _) = scene::build(&options);
                for part in [0.0, 0.6, 0.95] {
                    let pose = world.drive.pose_at(world.drive.one_way_s * part);
                    let camera = Camera::new(Intrinsics::of_size(size), pose);
                    for object in observe(&world, &camera) {
                        compare(
                            &world,
                            &camera,
                            &object,
                            &format!("{} in {options} at {part}", object.object),
                        );
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared >= 50, "only {compared} objects were compared");
    }

    fn compare(world: &World, camera: &Camera, object: &TrueObject, what: &str) {
        let SizePx { width, height } = camera.intrinsics.size;
        let [left, top, right, bottom] = object.bbox_px;
        let margin = 2.0;
        let around = [
            (left - margin).max(0.0),
            (top - margin).max(0.0),
            (right + margin).min(f64::from(width)),
            (bottom + margin).min(f64::from(height)),
        ];
        let (area_px2, [x, y]) = count(world, camera, &object.object, around);
        let side_px = (around[2] - around[0]).max(around[3] - around[1]);
        let slack_px2 = 0.01 * side_px * side_px;
        assert!(
            (area_px2 - object.area_px2).abs() < slack_px2,
            "{what}: {area_px2} against {}",
            object.area_px2
        );
        if object.area_px2 > 4.0 * slack_px2 {
            let off_px = (x - object.centroid_px[0]).hypot(y - object.centroid_px[1]);
            assert!(off_px < 0.01 * side_px, "{what}: centroid off by {off_px} px");
        }
        assert!((0.0..=1.0 + 1e-9).contains(&object.visible), "{what}: visible {}", object.visible);
    }

    #[test]
    fn the_picture_shows_the_object_where_the_truth_says() {
        let options = SceneOptions::new(SceneKind::Rink);
        let rendered = Simulator::new(options).unwrap().render(0);
        for object in rendered.truth.iter().filter(|object| object.object == "red") {
            let [r, g, b] = rendered.frame.pixel(object.centroid_px[0] as u32, object.centroid_px[1] as u32);
            assert!(r > 150 && g < 110 && b < 90, "{r} {g} {b}");
        }
    }

    #[test]
    fn frames_depend_on_options_and_number_only() {
        let options: SceneOptions = "sim:rink?seed=5&width=160&height=120".parse().unwrap();
        let mut simulator = Simulator::new(options).unwrap();
        let first = simulator.render(17);
        simulator.render(400);
        assert_eq!(simulator.render(17).frame, first.frame);
        assert_eq!(Simulator::new(options).unwrap().render(17).frame, first.frame);
        let other = Simulator::new(SceneOptions { vehicle: 1, ..options }).unwrap().render(17);
        assert_ne!(other.frame, first.frame);
        assert_ne!(other.truth, first.truth);
    }
}
