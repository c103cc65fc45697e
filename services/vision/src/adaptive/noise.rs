//! The camera's noise, told from the frame itself.

use crate::frame::Frame;

/// Places looked at in each direction.
const GRID: u32 = 48;

/// Noise variance of R, G and B, levels²: the median of squared second differences along rows, which flat and evenly
/// sloping parts of the picture leave to noise alone (their variance is six times the noise's).
pub(crate) fn variance(frame: &Frame) -> [f32; 3] {
    if frame.width() < 3 || frame.height() == 0 {
        return [0.0; 3];
    }
    std::array::from_fn(|channel| channel_variance(frame, channel))
}

fn channel_variance(frame: &Frame, channel: usize) -> f32 {
    let mut squares: Vec<f32> = Vec::with_capacity((GRID * GRID) as usize);
    for j in 0..GRID {
        let row = frame.row((2 * j + 1) * frame.height() / (2 * GRID));
        for i in 0..GRID {
            let x = ((2 * i + 1) * (frame.width() - 2) / (2 * GRID)) as usize;
            let level = |k: usize| f32::from(row[3 * (x + k) + channel]);
            squares.push((level(0) - 2.0 * level(1) + level(2)).powi(2));
        }
    }
    let middle = squares.len() / 2;
    let (_, median, _) = squares.select_nth_unstable_by(middle, f32::total_cmp);
    // The median of a squared normal variable is 0.455 of its variance.
    *median / 0.455 / 6.0
}
