//! Between 4:2:0 luma and chroma and RGB (ITU-R BT.601 and BT.709; ITU-T H.264, clause E.2.1), in 16-bit fixed point.

use crate::sequence::{ColourCoding, ColourMatrix, LevelRange};

/// The planes of a 4:2:0 picture: chroma at half the columns and rows, rounded up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planes<'a> {
    pub(crate) luma: &'a [u8],
    pub(crate) blue: &'a [u8],
    pub(crate) red: &'a [u8],
    pub(crate) luma_stride: usize,
    pub(crate) chroma_stride: usize,
}

const ONE: f64 = 65_536.0;
const HALF: i32 = 1 << 15;

/// Multipliers in units of 2⁻¹⁶.
struct ToRgb {
    black: i32,
    luma: i32,
    red_of_red: i32,
    green_of_red: i32,
    green_of_blue: i32,
    blue_of_blue: i32,
}

impl ToRgb {
    fn new(coding: ColourCoding) -> Self {
        let (red, blue) = weights(coding.matrix);
        let green = 1.0 - red - blue;
        let (black, luma, chroma) = match coding.range {
            LevelRange::Limited => (16, 255.0 / 219.0, 255.0 / 112.0),
            LevelRange::Full => (0, 1.0, 255.0 / 127.5),
        };
        let fixed = |value: f64| (value * ONE).round() as i32;
        Self {
            black,
            luma: fixed(luma),
            red_of_red: fixed(chroma * (1.0 - red)),
            green_of_red: fixed(-chroma * (1.0 - red) * red / green),
            green_of_blue: fixed(-chroma * (1.0 - blue) * blue / green),
            blue_of_blue: fixed(chroma * (1.0 - blue)),
        }
    }
}

/// The weights of red and blue in luma; green has the rest.
fn weights(matrix: ColourMatrix) -> (f64, f64) {
    match matrix {
        ColourMatrix::Bt601 => (0.299, 0.114),
        ColourMatrix::Bt709 => (0.2126, 0.0722),
    }
}

/// Writes `width` × `height` interleaved RGB pixels; each chroma sample serves its four pixels.
pub(crate) fn write_rgb(
    planes: Planes<'_>,
    coding: ColourCoding,
    (width, height): (usize, usize),
    rgb: &mut [u8],
) {
    let k = ToRgb::new(coding);
    for (y, row) in rgb.chunks_exact_mut(3 * width).take(height).enumerate() {
        let luma = &planes.luma[y * planes.luma_stride..][..width];
        let chroma = y / 2 * planes.chroma_stride;
        let (blue, red) = (&planes.blue[chroma..], &planes.red[chroma..]);
        for (((pixels, luma), &blue), &red) in row.chunks_mut(6).zip(luma.chunks(2)).zip(blue).zip(red) {
            let (blue, red) = (i32::from(blue) - 128, i32::from(red) - 128);
            let add = [
                k.red_of_red * red + HALF,
                k.green_of_red * red + k.green_of_blue * blue + HALF,
                k.blue_of_blue * blue + HALF,
            ];
            for (pixel, &luma) in pixels.chunks_exact_mut(3).zip(luma) {
                let luma = k.luma * (i32::from(luma) - k.black);
                for (level, add) in pixel.iter_mut().zip(add) {
                    *level = ((luma + add) >> 16).clamp(0, 255) as u8;
                }
            }
        }
    }
}

/// Luma, blue and red planes of an RGB picture of even width and height in BT.709, limited range; chroma is the mean of
/// four pixels.
pub(crate) fn planes_from_rgb(rgb: &[u8], stride: usize, (width, height): (usize, usize)) -> Vec<u8> {
    let (red, blue) = weights(ColourMatrix::Bt709);
    let luma_weights = [red, 1.0 - red - blue, blue].map(|weight| (weight * 219.0 / 255.0 * ONE) as i32);
    let chroma_scale = |own: f64| 112.0 / 255.0 / (1.0 - own) / 4.0 * ONE;
    let blue_weights = [-red, red + blue - 1.0, 1.0 - blue].map(|w| (w * chroma_scale(blue)) as i32);
    let red_weights = [1.0 - red, red + blue - 1.0, -blue].map(|w| (w * chroma_scale(red)) as i32);
    let weigh =
        |weights: [i32; 3], levels: [i32; 3]| weights.iter().zip(levels).map(|(w, l)| w * l).sum::<i32>();
    let mut planes = Vec::with_capacity(width * height * 3 / 2);
    for row in rgb.chunks_exact(3 * stride).take(height) {
        planes.extend(row.chunks_exact(3).take(width).map(|pixel| {
            let levels = [i32::from(pixel[0]), i32::from(pixel[1]), i32::from(pixel[2])];
            (((weigh(luma_weights, levels) + HALF) >> 16) + 16) as u8
        }));
    }
    for weights in [blue_weights, red_weights] {
        for two in rgb.chunks_exact(6 * stride).take(height / 2) {
            let (upper, lower) = two.split_at(3 * stride);
            let blocks = upper.chunks_exact(6).zip(lower.chunks_exact(6)).take(width / 2);
            planes.extend(blocks.map(|(upper, lower)| {
                let sum = [0, 1, 2]
                    .map(|c| [upper[c], upper[c + 3], lower[c], lower[c + 3]].map(i32::from).iter().sum());
                (((weigh(weights, sum) + HALF) >> 16) + 128) as u8
            }));
        }
    }
    planes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CODING: ColourCoding = ColourCoding { matrix: ColourMatrix::Bt709, range: LevelRange::Limited };

    fn there_and_back(colour: [u8; 3]) -> [u8; 3] {
        let planes = planes_from_rgb(&colour.repeat(4), 2, (2, 2));
        let planes = Planes {
            luma: &planes[..4],
            blue: &planes[4..5],
            red: &planes[5..],
            luma_stride: 2,
            chroma_stride: 1,
        };
        let mut rgb = [0; 12];
        write_rgb(planes, CODING, (2, 2), &mut rgb);
        [rgb[9], rgb[10], rgb[11]]
    }

    #[test]
    fn black_and_white_are_exact() {
        for level in [0, 255] {
            assert_eq!(there_and_back([level; 3]), [level; 3]);
        }
    }

    #[test]
    fn the_matrices_are_those_of_the_standards() {
        // BT.601 and BT.709 in limited range, luma 81 and chroma 90, 240: pure red of BT.601 colour bars.
        let planes = Planes { luma: &[81], blue: &[90], red: &[240], luma_stride: 1, chroma_stride: 1 };
        let mut rgb = [0; 3];
        write_rgb(planes, ColourCoding { matrix: ColourMatrix::Bt601, ..CODING }, (1, 1), &mut rgb);
        assert_eq!(rgb, [254, 0, 0]);
        let planes = Planes { luma: &[63], blue: &[102], red: &[240], luma_stride: 1, chroma_stride: 1 };
        write_rgb(planes, CODING, (1, 1), &mut rgb);
        assert_eq!(rgb, [255, 1, 0]);
        let planes = Planes { luma: &[200], blue: &[128], red: &[128], luma_stride: 1, chroma_stride: 1 };
        write_rgb(planes, ColourCoding { range: LevelRange::Full, ..CODING }, (1, 1), &mut rgb);
        assert_eq!(rgb, [200; 3]);
    }

    proptest! {
        #[test]
        fn a_flat_colour_comes_back_within_the_steps_of_the_limited_range(colour: [u8; 3]) {
            let back = there_and_back(colour);
            let worst = colour.iter().zip(back).map(|(a, b)| a.abs_diff(b)).max().unwrap();
            prop_assert!(worst <= 3, "{colour:?} became {back:?}");
        }
    }
}
