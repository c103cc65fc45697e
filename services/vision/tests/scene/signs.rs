//! Lettered road signs before a sky and grass: octagons and boards.

use super::fine;
use vision::{Frame, Landmark, LearnOptions, PointPx, RectPx, ShapeClass, learn};

const WIDTH: u32 = 240;
const HEIGHT: u32 = 140;
const WHITE: [f32; 3] = [190.0, 194.0, 190.0];

/// An octagon or a board.
#[derive(Clone, Copy)]
pub(crate) struct Sign {
    pub(crate) shape: ShapeClass,
    pub(crate) centre: PointPx,
    pub(crate) width_px: f32,
}

impl Sign {
    pub(crate) fn new(shape: ShapeClass, (x, y): (f32, f32), width_px: f32) -> Self {
        Self { shape, centre: PointPx::new(x, y), width_px }
    }

    /// The sign that its landmark is learned from.
    fn sample(shape: ShapeClass) -> Self {
        Self::new(shape, (120.0, 70.0), 60.0)
    }

    fn height_px(&self) -> f32 {
        if self.is_board() { self.width_px / 2.0 } else { self.width_px }
    }

    fn is_board(&self) -> bool {
        self.shape == ShapeClass::Rectangle
    }

    fn own_color(&self) -> [f32; 3] {
        if self.is_board() { [10.0, 84.0, 54.0] } else { [176.0, 22.0, 34.0] }
    }

    /// Its colour at a place, if that lies on it: a border, and two lines of letters that are stems.
    fn color_at(&self, x: f32, y: f32) -> Option<[f32; 3]> {
        let (u, v) = ((x - self.centre.x) / self.width_px, (y - self.centre.y) / self.height_px());
        // Half the width over flats is 0.5 in every direction of them.
        let diagonal = if self.is_board() { 0.0 } else { (u.abs() + v.abs()) / std::f32::consts::SQRT_2 };
        let radius = u.abs().max(v.abs()).max(diagonal);
        let line = (0.08..0.3).contains(&v.abs());
        let stem = u.abs() < 0.35 && ((u + 0.35) * 14.0).fract() < 0.45;
        let color = if radius > 0.46 || (line && stem) { WHITE } else { self.own_color() };
        (radius < 0.5).then_some(color)
    }
}

/// Signs, the first in front.
pub(crate) fn picture(signs: &[Sign]) -> Frame {
    let sample = |x: f32, y: f32| {
        let ground = if y < 80.0 { [150.0, 178.0, 220.0] } else { [112.0, 116.0, 98.0] };
        signs.iter().find_map(|sign| sign.color_at(x, y)).unwrap_or(ground)
    };
    Frame::from_rgb(WIDTH, HEIGHT, fine::rgb(WIDTH, HEIGHT, sample)).unwrap()
}

/// What is learned of one sign of a shape.
pub(crate) fn landmark(shape: ShapeClass) -> Landmark {
    let sign = Sign::sample(shape);
    let (width, height) = (sign.width_px, sign.height_px());
    let region = RectPx {
        x: (sign.centre.x - width / 2.0) as u32,
        y: (sign.centre.y - height / 2.0) as u32,
        width: width as u32,
        height: height as u32,
    };
    let options = LearnOptions { id: shape.name().into(), shape, ..LearnOptions::default() };
    learn(&[(&picture(&[sign]), region)], &options).unwrap()
}
