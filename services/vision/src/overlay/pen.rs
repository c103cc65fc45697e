//! Lines with a dark rim.

use tiny_skia::{
    Color, FillRule, IntSize, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash,
    Transform,
};

use crate::frame::Frame;
use crate::geometry::PointPx;

/// The colour of a landmark, R, G, B.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ink(pub(super) [u8; 3]);

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StrokeKind {
    Thin,
    Thick,
    Dashed,
}

/// Opacity of the dark rim around every line.
const RIM_OPACITY: u8 = 190;
/// Width of the rim on each side, px.
const RIM_PX: f32 = 1.2;
/// Lines are as wide as stated at this frame width, and grow with it.
const NOMINAL_WIDTH_PX: f32 = 640.0;
/// Coordinates beyond this are not drawn, px.
const FURTHEST_PX: f32 = 1e5;

/// Draws over a copy of the frame.
pub(super) struct Pen {
    pixmap: Pixmap,
    scale: f32,
}

impl Pen {
    /// `None` for a frame without pixels.
    pub(super) fn over(frame: &Frame) -> Option<Self> {
        let rgba = frame.rgb().as_chunks::<3>().0.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let pixmap = Pixmap::from_vec(rgba, IntSize::from_wh(frame.width(), frame.height())?)?;
        let scale = (frame.width() as f32 / NOMINAL_WIDTH_PX).clamp(1.0, 3.0);
        Some(Self { pixmap, scale })
    }

    pub(super) fn write_to(&self, frame: &mut Frame) {
        let drawn = self.pixmap.data().as_chunks::<4>().0;
        for (pixel, &[r, g, b, _]) in frame.rgb_mut().as_chunks_mut::<3>().0.iter_mut().zip(drawn) {
            *pixel = [r, g, b];
        }
    }

    pub(super) fn line(&mut self, from: PointPx, to: PointPx, kind: StrokeKind, ink: Ink) {
        self.stroke(path_through(&[from, to], Ends::Open), kind, ink);
    }

    pub(super) fn polygon(&mut self, corners: &[PointPx], kind: StrokeKind, ink: Ink) {
        self.stroke(path_through(corners, Ends::Joined), kind, ink);
    }

    /// A line whose head, two short strokes, ends in `to`.
    pub(super) fn arrow(&mut self, from: PointPx, to: PointPx, ink: Ink) {
        let length_px = from.distance_px(to).max(1.0);
        let head_px = (9.0 * self.scale).min(length_px);
        let (x, y) = ((from.x - to.x) / length_px * head_px, (from.y - to.y) / length_px * head_px);
        let side = |turn: f32| PointPx::new(to.x + x - turn * y * 0.4, to.y + y + turn * x * 0.4);
        self.line(from, to, StrokeKind::Thin, ink);
        self.stroke(path_through(&[side(1.0), to, side(-1.0)], Ends::Open), StrokeKind::Thin, ink);
    }

    pub(super) fn ellipse(&mut self, centre: PointPx, radii_px: [f32; 2], kind: StrokeKind, ink: Ink) {
        let corners: Vec<PointPx> = (0..72_u8)
            .map(|i| {
                let (sin, cos) = (f32::from(i) * std::f32::consts::TAU / 72.0).sin_cos();
                PointPx::new(centre.x + radii_px[0] * cos, centre.y + radii_px[1] * sin)
            })
            .collect();
        self.polygon(&corners, kind, ink);
    }

    /// The sign for a prediction that came true.
    pub(super) fn diamond(&mut self, centre: PointPx, ink: Ink) {
        let arm = 4.0 * self.scale;
        let corners = [(arm, 0.0), (0.0, arm), (-arm, 0.0), (0.0, -arm)];
        self.polygon(&corners.map(|(x, y)| PointPx::new(centre.x + x, centre.y + y)), StrokeKind::Thin, ink);
    }

    /// The sign for a prediction that did not: a dashed diagonal cross as large as the object.
    pub(super) fn cross(&mut self, centre: PointPx, arm_px: f32, ink: Ink) {
        let arm = arm_px.max(6.0 * self.scale);
        for side in [1.0, -1.0] {
            let from = PointPx::new(centre.x - arm, centre.y - side * arm);
            let to = PointPx::new(centre.x + arm, centre.y + side * arm);
            self.line(from, to, StrokeKind::Dashed, ink);
        }
    }

    pub(super) fn dot(&mut self, centre: PointPx, ink: Ink) {
        let radius = 2.2 * self.scale;
        for (radius, paint) in [(radius + RIM_PX, rim()), (radius, opaque(ink))] {
            let circle =
                is_drawable(centre).then(|| PathBuilder::from_circle(centre.x, centre.y, radius)).flatten();
            if let Some(circle) = circle {
                self.pixmap.fill_path(&circle, &paint, FillRule::Winding, Transform::identity(), None);
            }
        }
    }

    fn stroke(&mut self, path: Option<Path>, kind: StrokeKind, ink: Ink) {
        let Some(path) = path else { return };
        let (width, dash) = match kind {
            StrokeKind::Thin => (1.3, None),
            StrokeKind::Thick => (2.6, None),
            StrokeKind::Dashed => (1.3, StrokeDash::new(vec![6.0 * self.scale, 5.0 * self.scale], 0.0)),
        };
        let width = width * self.scale;
        for (width, paint) in [(width + 2.0 * RIM_PX, rim()), (width, opaque(ink))] {
            let stroke = Stroke {
                width,
                line_cap: LineCap::Round,
                line_join: LineJoin::Round,
                dash: dash.clone(),
                ..Stroke::default()
            };
            self.pixmap.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
    }
}

/// Whether a path ends where it began.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ends {
    Open,
    Joined,
}

fn is_drawable(point: PointPx) -> bool {
    point.x.abs() < FURTHEST_PX && point.y.abs() < FURTHEST_PX
}

/// `None` for less than two points, or where one of them lies out of all bounds.
fn path_through(points: &[PointPx], ends: Ends) -> Option<Path> {
    let [first, rest @ ..] = points else { return None };
    if rest.is_empty() || !points.iter().copied().all(is_drawable) {
        return None;
    }
    let mut path = PathBuilder::new();
    path.move_to(first.x, first.y);
    for point in rest {
        path.line_to(point.x, point.y);
    }
    if ends == Ends::Joined {
        path.close();
    }
    path.finish()
}

fn rim() -> Paint<'static> {
    paint(Color::from_rgba8(0, 0, 0, RIM_OPACITY))
}

fn opaque(Ink([r, g, b]): Ink) -> Paint<'static> {
    paint(Color::from_rgba8(r, g, b, 255))
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(color);
    paint
}
