//! How sharp a frame is, told from its own edges: what is finer than its blur cannot be expected to show.

use crate::frame::Frame;

/// Rows looked at.
const ROWS: u32 = 32;
/// Both sides of an edge are judged this far from its middle, px.
const BESIDE: usize = 4;
/// Edges of less contrast drown in noise, levels.
const LEAST_CONTRAST: u32 = 40;
/// Fewer edges than this tell nothing.
const LEAST_EDGES: u32 = 12;
/// The blur of a good camera, px: taken where a frame has no edges.
const USUAL_PX: f32 = 0.55;
/// Steps of the ratio that are told apart.
const STEPS: usize = 64;
/// Of the edges, this part is blurred more: by their own motion, or by lying askew.
const SHARPER_THAN: f32 = 0.7;

/// Standard deviation of the blur, px. Across an edge blurred by a Gaussian the greatest difference of neighbours is the
/// contrast times erf(1 / (2√2 σ)); the sharper edges of the frame tell σ.
pub(crate) fn blur_px(frame: &Frame) -> f32 {
    let mut counts = [0_u32; STEPS + 1];
    let width = frame.width() as usize;
    if width <= 2 * BESIDE + 1 || frame.height() == 0 {
        return USUAL_PX;
    }
    for row in (0..ROWS).map(|row| frame.row((2 * row + 1) * frame.height() / (2 * ROWS))) {
        let level = |x: usize| u32::from(row[3 * x + 1]);
        for x in BESIDE..width - BESIDE - 1 {
            let contrast = level(x + BESIDE).abs_diff(level(x + 1 - BESIDE));
            let step = level(x + 1).abs_diff(level(x));
            let steepest =
                step >= level(x).abs_diff(level(x - 1)) && step > level(x + 2).abs_diff(level(x + 1));
            if contrast >= LEAST_CONTRAST && steepest {
                counts[(step as usize * STEPS / contrast as usize).min(STEPS)] += 1;
            }
        }
    }
    let edges: u32 = counts.iter().sum();
    if edges < LEAST_EDGES {
        return USUAL_PX;
    }
    let mut below = 0;
    let passes = |&count: &u32| {
        below += count;
        below as f32 >= SHARPER_THAN * edges as f32
    };
    let ratio = (counts.iter().position(passes).unwrap_or(STEPS) as f32 + 0.5) / STEPS as f32;
    // erf(z) ≈ 2 z / √π for small z, which is near enough down to the sharpest edges a camera makes.
    (0.4 / ratio.clamp(0.1, 0.9)).max(0.4)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bars of 16 pixels, blurred by a Gaussian.
    fn bars(sigma_px: f32) -> Frame {
        let weights: Vec<f32> = (-8..=8).map(|at| (-0.5 * (at as f32 / sigma_px).powi(2)).exp()).collect();
        let total: f32 = weights.iter().sum();
        let bar = |x: i32| if x.rem_euclid(32) < 16 { 40.0 } else { 200.0 };
        let level = |x: i32| {
            let mixed: f32 = weights.iter().zip(-8..).map(|(weight, at)| weight * bar(x + at)).sum();
            [(mixed / total) as u8; 3]
        };
        let rgb = (0..40).flat_map(|_| (0..320).flat_map(level)).collect();
        Frame::from_rgb(320, 40, rgb).unwrap()
    }

    #[test]
    fn the_blur_of_an_edge_is_told() {
        for sigma_px in [0.7, 1.0, 1.5, 2.0] {
            let told = blur_px(&bars(sigma_px));
            assert!((told / sigma_px - 1.0).abs() < 0.2, "{told} of {sigma_px}");
        }
    }

    #[test]
    fn a_frame_without_edges_counts_as_a_good_cameras() {
        let plain = Frame::from_rgb(64, 48, vec![90; 3 * 64 * 48]).unwrap();
        assert_eq!(blur_px(&plain), USUAL_PX);
        assert_eq!(blur_px(&Frame::from_rgb(3, 3, vec![90; 27]).unwrap()), USUAL_PX);
        assert_eq!(blur_px(&Frame::from_rgb(12, 0, Vec::new()).unwrap()), USUAL_PX);
    }
}
