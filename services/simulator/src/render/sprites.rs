//! Things in front of the planes, drawn with exact edges and averaged over the exposure.

use super::canvas::Canvas;
use super::coverage::{Coverage, Region};
use crate::camera::Camera;
use crate::polygon::{Point, bounds, inside_frame};
use crate::world::{Body, Colour, Face, Item, Layer, Shadow};

/// Things smaller than this are not drawn, px.
const LEAST_SIDE_PX: f64 = 0.2;

/// A thing as one camera sees it: its outline, and the visible faces as polygons.
struct Look {
    silhouette: Vec<Point>,
    faces: Vec<(Vec<Point>, Colour, Layer)>,
}

/// Working memory, kept from thing to thing.
#[derive(Debug, Default)]
pub(crate) struct Brush {
    coverage: Coverage,
    /// Colour of the surface in one pixel times its weight, and the weight.
    surface: Vec<[f32; 4]>,
    /// Opacity alone, summed over the exposure.
    opacity: Vec<f32>,
    /// Colour times opacity, and opacity, summed over the exposure.
    layer: Vec<[f32; 4]>,
}

impl Brush {
    /// Darkens the ground where the shadow falls.
    pub(crate) fn draw_shadow(&mut self, shadow: &Shadow, camera: &Camera, canvas: &mut Canvas) {
        let polygon = clipped(&camera.polygon_from_world(&shadow.corners), canvas);
        if polygon.is_empty() {
            return;
        }
        let region = Region::around(bounds(&polygon));
        let parts = self.coverage.of(&polygon, &region);
        let darkness = shadow.darkness as f32;
        for (row, parts) in canvas.region_rows_mut(&region).zip(parts.chunks_exact(region.columns.len())) {
            for (pixel, part) in row.iter_mut().zip(parts) {
                *pixel = pixel.map(|level| (f32::from(level) * (1.0 - darkness * part) + 0.5) as u8);
            }
        }
    }

    /// Draws a thing as the mean over `cameras`, the camera's poses during the exposure.
    pub(crate) fn draw_item(&mut self, item: &Item, cameras: &[Camera], canvas: &mut Canvas) {
        let looks: Vec<Look> = cameras.iter().map(|camera| look(item, camera, canvas)).collect();
        let all: Vec<Point> = looks.iter().flat_map(|look| look.silhouette.iter().copied()).collect();
        let [left, top, right, bottom] = bounds(&all);
        if right - left < LEAST_SIDE_PX || bottom - top < LEAST_SIDE_PX {
            return;
        }
        let region = Region::around([left, top, right, bottom]);
        if let Some(colour) = only_colour(&looks) {
            self.draw_flat(&looks, colour, &region, canvas);
            return;
        }
        self.layer.clear();
        self.layer.resize(region.pixels(), [0.0; 4]);
        for look in looks.iter().filter(|look| !look.silhouette.is_empty()) {
            self.add_look(look, &region, 1.0 / looks.len() as f32);
        }
        for (row, layer) in canvas.region_rows_mut(&region).zip(self.layer.chunks_exact(region.columns.len()))
        {
            for (pixel, &[r, g, b, opacity]) in row.iter_mut().zip(layer) {
                let over = |under: u8, colour: f32| (f32::from(under) * (1.0 - opacity) + colour + 0.5) as u8;
                *pixel = [over(pixel[0], r), over(pixel[1], g), over(pixel[2], b)];
            }
        }
    }

    /// The short way for things of one colour: only their opacity is averaged.
    fn draw_flat(&mut self, looks: &[Look], colour: Colour, region: &Region, canvas: &mut Canvas) {
        self.opacity.clear();
        self.opacity.resize(region.pixels(), 0.0);
        for look in looks {
            let parts = self.coverage.of(&look.silhouette, region);
            for (sum, part) in self.opacity.iter_mut().zip(parts) {
                *sum += part;
            }
        }
        let weight = 1.0 / looks.len() as f32;
        let colour = colour.map(|level| level as f32);
        for (row, sums) in canvas.region_rows_mut(region).zip(self.opacity.chunks_exact(region.columns.len()))
        {
            for (pixel, sum) in row.iter_mut().zip(sums).filter(|(_, sum)| **sum > 0.0) {
                let over = |channel: usize| {
                    let under = f32::from(pixel[channel]);
                    (under + (colour[channel] - under) * sum * weight + 0.5) as u8
                };
                *pixel = [over(0), over(1), over(2)];
            }
        }
    }

    /// The surface's colour first, then the outline's exact coverage as its opacity: faces that share an edge leave
    /// no seam, and the edge of the whole is as sharp as the truth says.
    fn add_look(&mut self, look: &Look, region: &Region, weight: f32) {
        self.paint_surface(look, region);
        let parts = self.coverage.of(&look.silhouette, region);
        for ((layer, &[r, g, b, sum]), part) in self.layer.iter_mut().zip(&self.surface).zip(parts) {
            if *part > 0.0 && sum > 0.0 {
                let opacity = weight * part;
                let scale = opacity / sum;
                for (total, add) in layer.iter_mut().zip([r * scale, g * scale, b * scale, opacity]) {
                    *total += add;
                }
            }
        }
    }

    fn paint_surface(&mut self, look: &Look, region: &Region) {
        // A trace of the first face everywhere, for pixels that the outline touches and rounding leaves to no face.
        let ground = look.faces.first().map_or([0.0; 4], |(_, colour, _)| with_weight(*colour, 1e-4));
        self.surface.clear();
        self.surface.resize(region.pixels(), ground);
        for (polygon, colour, layer) in &look.faces {
            let parts = self.coverage.of(polygon, region);
            for (pixel, &part) in self.surface.iter_mut().zip(parts).filter(|(_, part)| **part > 0.0) {
                let [.., sum] = *pixel;
                let (keep, add) = match layer {
                    Layer::Surface => (1.0, part),
                    Layer::Paint => (1.0 - part, part * sum),
                };
                let added = with_weight(*colour, add);
                for (total, add) in pixel.iter_mut().zip(added) {
                    *total = *total * keep + add;
                }
            }
        }
    }
}

/// The colour of a thing that shows one face, and the same one, at every moment.
fn only_colour(looks: &[Look]) -> Option<Colour> {
    let colour_of = |look: &Look| match look.faces[..] {
        [(_, colour, _)] => Some(colour),
        _ => None,
    };
    let first = looks.first().and_then(colour_of)?;
    looks.iter().all(|look| colour_of(look) == Some(first)).then_some(first)
}

fn with_weight([r, g, b]: Colour, weight: f32) -> [f32; 4] {
    [r as f32 * weight, g as f32 * weight, b as f32 * weight, weight]
}

fn clipped(polygon: &[Point], canvas: &Canvas) -> Vec<Point> {
    let size = canvas.size();
    inside_frame(polygon, f64::from(size.width), f64::from(size.height))
}

fn look(item: &Item, camera: &Camera, canvas: &Canvas) -> Look {
    let silhouette = clipped(&item.silhouette(camera), canvas);
    let faces = match &item.body {
        _ if silhouette.is_empty() => Vec::new(),
        Body::Ball { colour, .. } => vec![(Vec::new(), *colour, Layer::Surface)],
        Body::Solid(faces) => visible_faces(faces, camera, canvas),
    };
    Look { silhouette, faces }
}

fn visible_faces(faces: &[Face], camera: &Camera, canvas: &Canvas) -> Vec<(Vec<Point>, Colour, Layer)> {
    faces
        .iter()
        .filter(|face| face.is_seen_from(camera.position))
        .map(|face| (clipped(&camera.polygon_from_world(&face.corners), canvas), face.colour, face.layer))
        .filter(|(polygon, ..)| !polygon.is_empty())
        .collect()
}
