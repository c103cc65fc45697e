//! Lines and marks drawn over frames, pixel by pixel.

use vision::{Frame, PointPx};

/// Draws a straight line, `width` pixels wide.
pub(crate) fn line(frame: &mut Frame, from: PointPx, to: PointPx, width: u32, colour: [u8; 3]) {
    // Two steps a pixel: rounding leaves no gap.
    let steps = (2.0 * (to.x - from.x).abs().max((to.y - from.y).abs()).ceil()).max(1.0) as u32;
    for step in 0..=steps {
        let part = step as f32 / steps as f32;
        let at = PointPx::new(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y));
        dot(frame, at, width, colour);
    }
}

/// Draws a square of `width` pixels around a point; what lies outside the picture is left out.
pub(crate) fn dot(frame: &mut Frame, at: PointPx, width: u32, colour: [u8; 3]) {
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

/// Draws the sides of a square around a point.
pub(crate) fn square(frame: &mut Frame, centre: PointPx, side: f32, width: u32, colour: [u8; 3]) {
    let half = side / 2.0;
    let corner = |x: f32, y: f32| PointPx::new(centre.x + x * half, centre.y + y * half);
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    for (at, from) in corners.into_iter().enumerate() {
        line(frame, from, corners[(at + 1) % 4], width, colour);
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
    }
}
