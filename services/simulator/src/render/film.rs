//! What lens, processing and compression of a film make of a picture.

use vision::SizePx;
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};

use super::canvas::Canvas;

/// Levels are taken for light to this power.
const GAMMA: f32 = 2.2;
/// Weights of a blur reach so many standard deviations.
const REACH_SIGMAS: f64 = 3.0;
/// What the camera's own processing does to noise and edges before it sharpens, px.
const DEMOSAICED_SIGMA_PX: f64 = 0.45;

/// A camera whose pictures are those of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Film {
    /// Standard deviation of the lens's blur, px.
    pub(crate) lens_sigma_px: f64,
    /// Noise over a good camera's, in quarters.
    pub(crate) grain_q2: i16,
    /// How much of what a blur takes away is added again, as a part.
    pub(crate) sharpening: f32,
    /// 70 to 85: chroma is halved in both directions.
    pub(crate) jpeg_quality: u8,
}

impl Film {
    /// Blurs as the lens does, in linear light: what is bright spreads over what is dark.
    pub(crate) fn focus(&self, canvas: &mut Canvas) {
        let linear: Vec<f32> = (0..=255).map(|level| (level as f32 / 255.0).powf(GAMMA)).collect();
        let mut light: Vec<f32> = canvas.rgb().iter().map(|&level| linear[usize::from(level)]).collect();
        blur(&mut light, canvas.size(), self.lens_sigma_px);
        for (level, light) in canvas.rgb_mut().iter_mut().zip(light) {
            *level = (255.0 * light.powf(1.0 / GAMMA)).round() as u8;
        }
    }

    /// Processed, compressed and decoded again.
    pub(crate) fn developed(&self, mut canvas: Canvas) -> Canvas {
        let mut levels: Vec<f32> = canvas.rgb().iter().map(|&level| f32::from(level)).collect();
        blur(&mut levels, canvas.size(), DEMOSAICED_SIGMA_PX);
        let mut soft = levels.clone();
        blur(&mut soft, canvas.size(), 1.0);
        for (level, (sharp, soft)) in canvas.rgb_mut().iter_mut().zip(levels.into_iter().zip(soft)) {
            *level = (sharp + self.sharpening * (sharp - soft)).round().clamp(0.0, 255.0) as u8;
        }
        let quality = Quality::new(self.jpeg_quality).expect("70 to 85 are qualities");
        let bytes = encode_jpeg(&canvas.into_frame(), quality).expect("4096 pixels a side fit into a JPEG");
        Canvas::from(decode(&bytes, &DecodeLimits::default()).expect("what was just encoded is a JPEG"))
    }
}

/// A Gaussian blur of interleaved samples of three channels; beyond the border the border's pixels go on.
fn blur(samples: &mut [f32], size: SizePx, sigma_px: f64) {
    let reach = (REACH_SIGMAS * sigma_px).ceil().max(1.0) as i64;
    let weight = |at: i64| (-0.5 * (at as f64 / sigma_px).powi(2)).exp() as f32;
    let weights: Vec<f32> = (-reach..=reach).map(weight).collect();
    let total: f32 = weights.iter().sum();
    let weights: Vec<f32> = weights.iter().map(|weight| weight / total).collect();
    let (stride, height) = (3 * size.width as usize, size.height as usize);
    let margin = reach as usize;
    let mut across = vec![0.0_f32; samples.len()];
    let mut padded = Vec::with_capacity(stride + 6 * margin);
    for (row, out) in samples.chunks_exact(stride).zip(across.chunks_exact_mut(stride)) {
        padded.clear();
        padded.extend(row[..3].iter().cycle().take(3 * margin));
        padded.extend_from_slice(row);
        padded.extend(row[stride - 3..].iter().cycle().take(3 * margin));
        for (at, &weight) in weights.iter().enumerate() {
            add_weighted(out, &padded[3 * at..], weight);
        }
    }
    samples.fill(0.0);
    for (y, out) in samples.chunks_exact_mut(stride).enumerate() {
        for (at, &weight) in weights.iter().enumerate() {
            let from = (y + at).saturating_sub(margin).min(height - 1);
            add_weighted(out, &across[from * stride..], weight);
        }
    }
}

fn add_weighted(out: &mut [f32], samples: &[f32], weight: f32) {
    out.iter_mut().zip(samples).for_each(|(out, sample)| *out += weight * sample);
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: SizePx = SizePx { width: 48, height: 32 };

    #[test]
    fn a_blur_keeps_the_light_and_spreads_it_as_wide_as_stated() {
        let mut samples = vec![0.0; 3 * 48 * 32];
        let at = |x: usize, y: usize| 3 * (48 * y + x);
        samples[at(24, 16)] = 1.0;
        blur(&mut samples, SIZE, 1.2);
        let (mut sum, mut spread) = (0.0, 0.0);
        for x in 0..48 {
            let column: f32 = (0..32).map(|y| samples[at(x, y)]).sum();
            sum += column;
            spread += column * (x as f32 - 24.0).powi(2);
        }
        assert!((sum - 1.0).abs() < 1e-3 && (spread.sqrt() - 1.2).abs() < 0.03, "{sum} {spread}");
    }

    #[test]
    fn bright_spreads_over_dark_and_a_plain_picture_stays() {
        let film = Film { lens_sigma_px: 0.8, grain_q2: 4, sharpening: 0.3, jpeg_quality: 78 };
        let mut canvas = Canvas::new(SIZE);
        canvas.rgb_mut().fill(120);
        film.focus(&mut canvas);
        let canvas = film.developed(canvas);
        assert!(canvas.rgb().iter().all(|&level| level.abs_diff(120) <= 1));
        let mut edge = Canvas::new(SIZE);
        for row in edge.rows_mut() {
            row[3 * 24..].fill(240);
        }
        film.focus(&mut edge);
        let level = |x: usize| edge.rgb()[3 * (48 * 16 + x)];
        // The mean of black and 240 in linear light is 175, and the two pixels at the edge lie evenly around it.
        assert!(level(23) > 90 && level(24) > 200 && level(20) < 20, "{} {}", level(23), level(24));
    }
}
