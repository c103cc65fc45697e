//! The camera's noise, told from the frame itself.

use crate::frame::Frame;

/// Places looked at in each direction.
const GRID: u32 = 24;

/// Noise variance of R, G and B, levels²: the median of squared second differences along rows, which flat and evenly
/// sloping parts of the picture leave to noise alone (their variance is six times the noise's).
pub(crate) fn variance(frame: &Frame) -> [f32; 3] {
    if frame.width() < 3 || frame.height() == 0 {
        return [0.0; 3];
    }
    // Second differences lie within ±510; their squares are ordered as their sizes are.
    let mut counts = [[0_u16; 511]; 3];
    let columns: [usize; GRID as usize] =
        std::array::from_fn(|i| ((2 * i as u32 + 1) * (frame.width() - 2) / (2 * GRID)) as usize);
    for j in 0..GRID {
        let row = frame.row((2 * j + 1) * frame.height() / (2 * GRID));
        for x in columns {
            let three = &row[3 * x..3 * x + 9];
            for (channel, counts) in counts.iter_mut().enumerate() {
                let level = |k: usize| i32::from(three[3 * k + channel]);
                counts[(level(0) - 2 * level(1) + level(2)).unsigned_abs() as usize] += 1;
            }
        }
    }
    counts.map(|counts| variance_of(&counts))
}

fn variance_of(counts: &[u16; 511]) -> f32 {
    let mut below = 0;
    let passes_middle = |&count: &u16| {
        below += u32::from(count);
        below > GRID * GRID / 2
    };
    let median = counts.iter().position(passes_middle).unwrap_or(0) as f32;
    // The median of a squared normal variable is 0.455 of its variance.
    median * median / 0.455 / 6.0
}
