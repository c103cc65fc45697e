//! Computed pictures: numbers as grey or as colours, flow as lines.

use std::num::NonZeroU16;

use vision::methods::{Flow, Plane};
use vision::{Frame, PointPx};

use super::ExperimentError;
use crate::sketch::{dot, line};

/// The picture with every pixel `factor` times as wide and as high.
pub(super) fn enlarged(frame: &Frame, factor: u32) -> Result<Frame, ExperimentError> {
    let (width, height) = (frame.width() * factor, frame.height() * factor);
    let pixels = (0..height).flat_map(|y| (0..width).flat_map(move |x| frame.pixel(x / factor, y / factor)));
    Ok(Frame::from_rgb(width, height, pixels.collect())?)
}

/// A plane as grey: `black` and what is below is black, `white` and above white.
pub(super) fn grey(plane: &Plane, black: f32, white: f32) -> Result<Frame, ExperimentError> {
    let level = |value: f32| (255.0 * (value - black) / (white - black)).round().clamp(0.0, 255.0) as u8;
    coloured(plane, |value| [level(value); 3])
}

/// A plane as colours from blue (its least value) over green and yellow to red (its largest).
pub(super) fn heat(plane: &Plane) -> Result<Frame, ExperimentError> {
    let finite = || plane.values().iter().copied().filter(|value| value.is_finite());
    let (least, most) = (finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max));
    let span = (most - least).max(f32::MIN_POSITIVE);
    coloured(plane, |value| heat_colour((value - least) / span))
}

/// Blue, cyan, green, yellow, red for 0 to 1.
fn heat_colour(part: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; 5] = [
        [30.0, 50.0, 150.0],
        [40.0, 160.0, 210.0],
        [90.0, 190.0, 90.0],
        [240.0, 220.0, 60.0],
        [215.0, 40.0, 30.0],
    ];
    let place = part.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let at = (place as usize).min(STOPS.len() - 2);
    let mix = place - at as f32;
    std::array::from_fn(|channel| (STOPS[at][channel] * (1.0 - mix) + STOPS[at + 1][channel] * mix) as u8)
}

fn coloured(plane: &Plane, colour: impl Fn(f32) -> [u8; 3]) -> Result<Frame, ExperimentError> {
    let rgb = plane.values().iter().flat_map(|&value| colour(value)).collect();
    Ok(Frame::from_rgb(plane.width(), plane.height(), rgb)?)
}

/// The flow as lines over the picture, twice as large: one each `step` pixels, `times` as long as the flow, with a dot
/// where it begins.
pub(super) fn arrows(plane: &Plane, flow: &Flow, step: u32, times: f32) -> Result<Frame, ExperimentError> {
    const ENLARGED: u32 = 2;
    let mut frame = enlarged(&grey(plane, 0.0, 255.0)?, ENLARGED)?;
    let scale = ENLARGED as f32;
    for y in (step / 2..plane.height()).step_by(step as usize) {
        for x in (step / 2..plane.width()).step_by(step as usize) {
            let (u, v) = (times * flow.u.get(x, y), times * flow.v.get(x, y));
            let from = PointPx::new(scale * x as f32, scale * y as f32);
            if u.hypot(v) >= 1.0 {
                line(
                    &mut frame,
                    from,
                    PointPx::new(from.x + scale * u, from.y + scale * v),
                    2,
                    [255, 190, 40],
                );
                dot(&mut frame, from, 4, [220, 60, 30]);
            }
        }
    }
    Ok(frame)
}

/// A window's side.
pub(super) fn side(px: u16) -> NonZeroU16 {
    NonZeroU16::new(px).unwrap_or(NonZeroU16::MIN)
}
