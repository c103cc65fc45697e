//! Tints every place of a picture where a landmark's statistics match, before anything is made of it.

use crate::bitmask::{BitMask, Run};
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::{ColorStats, Landmark, WindowPx};
use crate::mask::Masker;
use crate::outcome::Adaptation;
use crate::probe::NoProbe;

/// Tints the centre of every window of `frame` that matches one of `landmarks`, each in its colour of the palette.
pub fn tint(frame: &mut Frame, landmarks: &[Landmark]) {
    let mut masker = Masker::default();
    let whole = RectPx::whole(frame.size());
    let found: Vec<(DoubledGrid, BitMask)> = landmarks
        .iter()
        .filter_map(|landmark| {
            let grid = DoubledGrid::new(whole, landmark.window_px)?;
            let mut mask = BitMask::default();
            masker.find(frame, &grid, landmark, &mut mask, &mut NoProbe);
            Some((grid, mask))
        })
        .collect();
    for (colour, (grid, mask)) in super::PALETTE.into_iter().cycle().zip(&found) {
        paint(frame, grid, mask, colour);
    }
}

/// The descriptor in the light and at the scale of one frame, as an outcome tells them. The noise that was taken out of
/// the frame is added to the descriptor, which is the same comparison.
#[must_use]
pub fn adapted(landmark: &Landmark, adaptation: &Adaptation) -> Landmark {
    let shade = |shade: &ColorStats| ColorStats {
        mean: shade
            .mean
            .map(|mean| ((mean + adaptation.haze).clamp(0.0, 255.0) * adaptation.gain).min(255.0)),
        variance: std::array::from_fn(|c| {
            shade.variance[c] * adaptation.gain * adaptation.gain + adaptation.noise_variance[c]
        }),
    };
    let mean = landmark.tolerance.mean.map(|mean| mean * adaptation.tolerance_scale);
    Landmark {
        window_px: WindowPx::square(adaptation.window_px.clamp(1, WindowPx::MAX_SIDE)),
        shades: landmark.shades.iter().map(shade).collect(),
        tolerance: ColorStats { mean, ..landmark.tolerance },
        ..landmark.clone()
    }
}

/// Halfway to the colour, on every second diagonal fully, so that it shows on its own colour too.
fn paint(frame: &mut Frame, grid: &DoubledGrid, mask: &BitMask, colour: [u8; 3]) {
    let size = frame.size();
    let mut runs: Vec<Run> = Vec::new();
    // Two rows of the doubled grid lie on each row of the picture: one of them is enough.
    for y in (0..mask.height()).step_by(2) {
        runs.clear();
        mask.append_runs(y, &mut runs);
        for run in &runs {
            let from = grid.frame_from_mask(f64::from(run.x_start), f64::from(y));
            let row = (from.y.max(0.0) as u32).min(size.height - 1);
            let left = (from.x.max(0.0) as u32).min(size.width - 1);
            let right = (left + run.length().div_ceil(2)).min(size.width);
            for x in left..right {
                let at = 3 * (row as usize * size.width as usize + x as usize);
                let is_hatched = (x + row).is_multiple_of(4);
                for (level, target) in frame.rgb_mut()[at..at + 3].iter_mut().zip(colour) {
                    *level = if is_hatched { target } else { u8::midpoint(*level, target) };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landmark::{Digest, ShapeClass};

    fn red() -> Landmark {
        Landmark {
            id: "red".into(),
            revision: 1,
            window_px: WindowPx::square(8),
            shades: vec![ColorStats { mean: [200.0, 40.0, 30.0], variance: [0.0; 3] }],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Any,
            size_m: None,
            digest: Digest::default(),
        }
    }

    /// A block in the middle of a grey picture.
    fn frame(block: [u8; 3]) -> Frame {
        let pixel = |x: usize, y: usize| {
            if (20..40).contains(&x) && (10..30).contains(&y) { block } else { [90, 120, 160] }
        };
        let rgb = (0..48).flat_map(|y| (0..64).flat_map(move |x| pixel(x, y))).collect();
        Frame::from_rgb(64, 48, rgb).unwrap()
    }

    fn changed(original: &Frame, tinted: &Frame) -> Vec<(u32, u32)> {
        let pixels = (0..48).flat_map(|y| (0..64).map(move |x| (x, y)));
        pixels.filter(|&(x, y)| original.pixel(x, y) != tinted.pixel(x, y)).collect()
    }

    #[test]
    fn only_what_matches_is_tinted_and_it_lies_on_the_object() {
        let original = frame([200, 40, 30]);
        let mut tinted = original.clone();
        tint(&mut tinted, &[red()]);
        let changed = changed(&original, &tinted);
        assert!(changed.len() > 200, "{}", changed.len());
        assert!(changed.iter().all(|(x, y)| (20..40).contains(x) && (10..30).contains(y)), "{changed:?}");
        assert!(changed.contains(&(30, 20)));
    }

    #[test]
    fn under_another_light_the_adapted_descriptor_matches() {
        let original = frame([100, 20, 15]);
        let tinted = |landmark: &Landmark| {
            let mut tinted = original.clone();
            tint(&mut tinted, std::slice::from_ref(landmark));
            !changed(&original, &tinted).is_empty()
        };
        let adaptation = Adaptation {
            gain: 0.5,
            haze: 0.0,
            noise_variance: [0.0; 3],
            window_px: 8,
            tolerance_scale: 1.0,
            full_frame: true,
        };
        assert!(!tinted(&red()));
        assert!(tinted(&adapted(&red(), &adaptation)));
        assert!(!tinted(&adapted(&red(), &Adaptation { haze: 60.0, ..adaptation })));
    }

    #[test]
    fn a_picture_smaller_than_the_window_stays_as_it_is() {
        let mut tiny = Frame::from_rgb(1, 1, vec![200, 40, 30]).unwrap();
        tint(&mut tiny, &[red()]);
        assert_eq!(tiny.pixel(0, 0), [200, 40, 30]);
    }
}
