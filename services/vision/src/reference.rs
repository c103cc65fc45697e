//! The slow, obvious mask: what the fast one must equal bit for bit. For tests and benchmarks only.

use crate::bitmask::BitMask;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::{Landmark, WindowPx};
use crate::statistics::{Acceptance, WindowSums};

/// The mask of `landmark` in `region` of `frame`, on a picture that really is enlarged twofold; `None` where no window
/// fits.
///
/// # Panics
/// When the region does not lie inside the frame.
#[must_use]
pub fn mask(frame: &Frame, region: RectPx, landmark: &Landmark) -> Option<BitMask> {
    let (width, height) = (2 * region.width, 2 * region.height);
    let WindowPx { width: window_width, height: window_height } = landmark.window_px;
    let (window_width, window_height) = (u32::from(window_width), u32::from(window_height));
    if window_width == 0 || window_height == 0 || window_width > width || window_height > height {
        return None;
    }
    let doubled: Vec<Vec<[u8; 3]>> = (0..height)
        .map(|y| (0..width).map(|x| frame.pixel(region.x + x / 2, region.y + y / 2)).collect())
        .collect();
    let samples = window_width * window_height;
    let accepted: Vec<_> = landmark
        .shades
        .iter()
        .filter_map(|shade| Acceptance::new(shade, &landmark.tolerance, samples))
        .collect();
    let mut mask = BitMask::new(width - window_width + 1, height - window_height + 1);
    for y in 0..mask.height() {
        for x in 0..mask.width() {
            let mut sums = WindowSums { samples, ..WindowSums::default() };
            for row in &doubled[y as usize..][..window_height as usize] {
                for pixel in &row[x as usize..][..window_width as usize] {
                    for (channel, &level) in pixel.iter().enumerate() {
                        sums.sum[channel] += u64::from(level);
                        sums.sum_of_squares[channel] += u64::from(level).pow(2);
                    }
                }
            }
            if accepted.iter().any(|accepted| accepted.accepts(&sums)) {
                mask.set(x, y);
            }
        }
    }
    Some(mask)
}
