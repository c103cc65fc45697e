//! Pictures that repeat over a plane, in halving resolutions (a mipmap).

/// A texture whose sides are powers of two; it repeats in both directions.
#[derive(Debug)]
pub(crate) struct Texture {
    log2_width: u32,
    log2_height: u32,
    /// Level 0 is the full resolution; a texel is `0x00BBGGRR`.
    levels: Vec<Vec<u32>>,
}

/// A position on level 0 in texels, 16.16 fixed point; it wraps as the texture does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TexelPosition {
    pub(crate) u: u32,
    pub(crate) v: u32,
}

impl TexelPosition {
    pub(crate) fn from_texels(u: f64, v: f64) -> Self {
        let fixed = |texels: f64| ((texels * 65_536.0) as i64) as u32;
        Self { u: fixed(u), v: fixed(v) }
    }
}

const RED_AND_BLUE: u32 = 0x00ff_00ff;
const GREEN: u32 = 0x0000_ff00;

/// a + (b − a) · weight / 256 for each channel.
fn mix(a: u32, b: u32, weight: u32) -> u32 {
    let keep = 256 - weight;
    let red_and_blue = ((a & RED_AND_BLUE) * keep + (b & RED_AND_BLUE) * weight) >> 8 & RED_AND_BLUE;
    let green = ((a & GREEN) >> 8) * keep + ((b & GREEN) >> 8) * weight;
    red_and_blue | (green & GREEN)
}

impl Texture {
    /// Paints level 0 by `paint(column, row)` (levels 0..255) and derives the coarser ones.
    pub(crate) fn paint(
        log2_width: u32,
        log2_height: u32,
        mut paint: impl FnMut(usize, usize) -> [f64; 3],
    ) -> Self {
        let (width, height) = (1_usize << log2_width, 1_usize << log2_height);
        let mut full = Vec::with_capacity(width * height);
        for row in 0..height {
            full.extend((0..width).map(|column| {
                let [r, g, b] = paint(column, row).map(|level| level.round().clamp(0.0, 255.0) as u32);
                r | g << 8 | b << 16
            }));
        }
        let mut levels = vec![full];
        for level in 1..=log2_width.min(log2_height) {
            let finer_width = width >> (level - 1);
            let finer = &levels[level as usize - 1];
            levels.push(halved(finer, finer_width));
        }
        Self { log2_width, log2_height, levels }
    }

    /// The coarsest level there is.
    pub(crate) fn coarsest(&self) -> u32 {
        self.levels.len() as u32 - 1
    }

    /// Writes `rgb` pixels from `from` on, `step` apart, interpolating between the texels of `level`.
    pub(crate) fn sample_span(&self, level: u32, from: TexelPosition, step: TexelPosition, rgb: &mut [u8]) {
        let texels = &self.levels[level as usize][..];
        let (log2_width, log2_height) = (self.log2_width - level, self.log2_height - level);
        let (mask_u, mask_v) = ((1_u32 << log2_width) - 1, (1_u32 << log2_height) - 1);
        let half = 1_u32 << (15 + level);
        let (mut u, mut v) = (from.u.wrapping_sub(half), from.v.wrapping_sub(half));
        for pixel in rgb.as_chunks_mut::<3>().0 {
            let (column, row) = (u >> (16 + level), v >> (16 + level));
            let (weight_u, weight_v) = (u >> (8 + level) & 0xff, v >> (8 + level) & 0xff);
            let upper = (row & mask_v) << log2_width;
            let lower = ((row + 1) & mask_v) << log2_width;
            let (left, right) = (column & mask_u, (column + 1) & mask_u);
            let texel = |row: u32, column: u32| texels[(row | column) as usize];
            let above = mix(texel(upper, left), texel(upper, right), weight_u);
            let below = mix(texel(lower, left), texel(lower, right), weight_u);
            let [r, g, b, _] = mix(above, below, weight_v).to_le_bytes();
            *pixel = [r, g, b];
            u = u.wrapping_add(step.u);
            v = v.wrapping_add(step.v);
        }
    }
}

/// Means of 2×2 texels.
fn halved(texels: &[u32], width: usize) -> Vec<u32> {
    texels
        .chunks_exact(2 * width)
        .flat_map(|rows| {
            (0..width / 2)
                .map(move |x| [rows[2 * x], rows[2 * x + 1], rows[width + 2 * x], rows[width + 2 * x + 1]])
        })
        .map(|four| {
            let channel = |shift: u32| (four.iter().map(|texel| texel >> shift & 0xff).sum::<u32>() + 2) / 4;
            channel(0) | channel(8) << 8 | channel(16) << 16
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkered() -> Texture {
        Texture::paint(
            3,
            2,
            |column, row| if (column + row) % 2 == 0 { [200.0, 40.0, 0.0] } else { [0.0, 40.0, 100.0] },
        )
    }

    fn sample(texture: &Texture, level: u32, u: f64, v: f64) -> [u8; 3] {
        let mut rgb = [0; 3];
        let step = TexelPosition { u: 0, v: 0 };
        texture.sample_span(level, TexelPosition::from_texels(u, v), step, &mut rgb);
        rgb
    }

    #[test]
    fn the_centre_of_a_texel_is_that_texel_and_between_two_is_their_mean() {
        let texture = checkered();
        assert_eq!(sample(&texture, 0, 0.5, 0.5), [200, 40, 0]);
        assert_eq!(sample(&texture, 0, 1.5, 0.5), [0, 40, 100]);
        assert_eq!(sample(&texture, 0, 1.0, 0.5), [100, 40, 50]);
    }

    #[test]
    fn it_repeats_in_both_directions() {
        let texture = checkered();
        assert_eq!(sample(&texture, 0, -7.5, 4.5), sample(&texture, 0, 0.5, 0.5));
        assert_eq!(sample(&texture, 0, 9.5, -3.5), sample(&texture, 0, 1.5, 0.5));
    }

    #[test]
    fn coarser_levels_are_means() {
        let texture = checkered();
        assert_eq!(texture.coarsest(), 2);
        assert_eq!(sample(&texture, 2, 3.3, 1.7), [100, 40, 50]);
    }
}
