//! Pictures drawn with smooth edges.

/// Samples a pixel in each direction.
const FINE: u32 = 4;

/// Levels of a picture whose pixels are means of the colours that `sample` gives at places on them.
pub(crate) fn rgb(width: u32, height: u32, sample: impl Fn(f32, f32) -> [f32; 3]) -> Vec<u8> {
    let pixel = |x: u32, y: u32| {
        let at = |base: u32, part: u32| base as f32 + (part as f32 + 0.5) / FINE as f32;
        let samples = (0..FINE * FINE).map(|k| sample(at(x, k % FINE), at(y, k / FINE)));
        let sum = samples.fold([0.0; 3], |sum, color| std::array::from_fn(|c| sum[c] + color[c]));
        sum.map(|total: f32| (total / (FINE * FINE) as f32).round() as u8)
    };
    let pixel = &pixel;
    (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y))).collect()
}
