//! The 14 steps as one would write them with `image` and `imageproc`.

use image::imageops::{FilterType, resize};
use image::{GrayImage, Luma, RgbImage};
use imageproc::contours::{Contour, find_contours};
use imageproc::hough::{LineDetectionOptions, PolarLine, detect_lines};
use imageproc::integral_image::{integral_image, integral_squared_image, sum_image_pixels};
use imageproc::region_labelling::{Connectivity, connected_components};
use vision::{ColorStats, Landmark};

/// What it finds: pixels of the largest component, contours and lines.
pub(crate) struct Found {
    pub(crate) largest_pixels: usize,
    pub(crate) contours: Vec<Contour<u32>>,
    pub(crate) lines: Vec<PolarLine>,
}

/// Steps 2 to 13.
pub(crate) fn register(frame: &RgbImage, landmark: &Landmark) -> Found {
    let mask = mask(frame, landmark);
    let labels = connected_components(&mask, Connectivity::Eight, Luma([0]));
    let mut pixels = Vec::<usize>::new();
    for &label in labels.as_raw().iter().filter(|&&label| label > 0) {
        pixels.resize(pixels.len().max(label as usize + 1), 0);
        pixels[label as usize] += 1;
    }
    let contours = find_contours::<u32>(&mask);
    let mut border = GrayImage::new(mask.width(), mask.height());
    for point in contours.iter().flat_map(|contour| &contour.points) {
        border.put_pixel(point.x, point.y, Luma([255]));
    }
    let lines = detect_lines(&border, LineDetectionOptions { vote_threshold: 8, suppression_radius: 4 });
    Found { largest_pixels: pixels.into_iter().max().unwrap_or(0), contours, lines }
}

fn mask(frame: &RgbImage, landmark: &Landmark) -> GrayImage {
    let doubled = resize(frame, 2 * frame.width(), 2 * frame.height(), FilterType::Nearest);
    let (sums, squares) = (integral_image::<_, u64>(&doubled), integral_squared_image::<_, u64>(&doubled));
    let (width, height) = (u32::from(landmark.window_px.width), u32::from(landmark.window_px.height));
    let samples = f64::from(width * height);
    let ColorStats { mean, variance } = landmark.shades[0];
    let mut mask = GrayImage::new(doubled.width() - width + 1, doubled.height() - height + 1);
    for (x, y, pixel) in mask.enumerate_pixels_mut() {
        let sum = sum_image_pixels(&sums, x, y, x + width - 1, y + height - 1);
        let square = sum_image_pixels(&squares, x, y, x + width - 1, y + height - 1);
        let matches = (0..3).all(|channel| {
            let window_mean = sum[channel] as f64 / samples;
            let window_variance = square[channel] as f64 / samples - window_mean * window_mean;
            (window_mean - f64::from(mean[channel])).abs() <= f64::from(landmark.tolerance.mean[channel])
                && (window_variance - f64::from(variance[channel])).abs()
                    <= f64::from(landmark.tolerance.variance[channel])
        });
        *pixel = Luma([255 * u8::from(matches)]);
    }
    mask
}
