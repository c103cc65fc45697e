//! Computed pictures: numbers as grey or as colours, and lines over frames.

use vision::{Frame, PointPx, RectPx};

use super::ExperimentError;

/// The picture with every pixel `factor` times as wide and as high.
pub(super) fn enlarged(frame: &Frame, factor: u32) -> Result<Frame, ExperimentError> {
    let (width, height) = (frame.width() * factor, frame.height() * factor);
    let pixels = (0..height).flat_map(|y| (0..width).flat_map(move |x| frame.pixel(x / factor, y / factor)));
    Ok(Frame::from_rgb(width, height, pixels.collect())?)
}

/// The part of the picture under `region`, as far as it lies inside.
pub(super) fn cropped(frame: &Frame, region: RectPx) -> Result<Frame, ExperimentError> {
    let RectPx { x, y, width, height } = region.clipped_to(frame.size()).unwrap_or_default();
    let pixels =
        (y..y + height).flat_map(|row| (x..x + width).flat_map(move |column| frame.pixel(column, row)));
    Ok(Frame::from_rgb(width, height, pixels.collect())?)
}

/// Draws a straight line, `width` pixels wide.
pub(super) fn line(frame: &mut Frame, from: PointPx, to: PointPx, width: u32, colour: [u8; 3]) {
    // Two steps a pixel: rounding leaves no gap.
    let steps = (2.0 * (to.x - from.x).abs().max((to.y - from.y).abs()).ceil()).max(1.0) as u32;
    for step in 0..=steps {
        let part = step as f32 / steps as f32;
        let at = PointPx::new(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y));
        dot(frame, at, width, colour);
    }
}

/// Draws a square of `width` pixels around a point; what lies outside the picture is left out.
pub(super) fn dot(frame: &mut Frame, at: PointPx, width: u32, colour: [u8; 3]) {
    let (columns, rows) = (i64::from(frame.width()), i64::from(frame.height()));
    let start = |centre: f32| (centre - (width as f32 - 1.0) / 2.0).floor() as i64;
    for y in start(at.y)..start(at.y) + i64::from(width) {
        for x in start(at.x)..start(at.x) + i64::from(width) {
            if (0..columns).contains(&x) && (0..rows).contains(&y) {
                let place = 3 * (y * columns + x) as usize;
                frame.rgb_mut()[place..place + 3].copy_from_slice(&colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_at_the_border() {
        let mut frame = Frame::from_rgb(4, 3, vec![0; 36]).unwrap();
        line(&mut frame, PointPx::new(-5.0, 1.5), PointPx::new(50.0, 1.5), 1, [9, 8, 7]);
        assert!((0..4).all(|x| frame.pixel(x, 1) == [9, 8, 7]));
        assert!((0..4).all(|x| frame.pixel(x, 0) == [0; 3]));
        assert_eq!(enlarged(&frame, 3).unwrap().pixel(0, 4), [9, 8, 7]);
    }
}
