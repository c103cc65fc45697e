//! What is tried.

use vision::learn::MAX_SHADES;
use vision::{ColorStats, Landmark, WindowPx};

use super::Change;

/// Sides of square windows that are tried, samples of the doubled grid.
const SIDES: [u16; 6] = [4, 6, 8, 12, 16, 24];
/// Factors on a tolerance that are tried.
const FACTORS: [f32; 5] = [0.5, 0.75, 1.5, 2.0, 3.0];
/// The landmark as given, and every sweep but that of the shades.
pub(super) const MOST_WITHOUT_SHADES: usize = 1 + SIDES.len() + 2 * FACTORS.len();
/// The largest tolerances that a descriptor may hold: what 8-bit levels can differ by.
const MAX_MEAN: f32 = 255.0;
const MAX_VARIANCE: f32 = 16_256.25;

/// Landmarks that differ from `landmark` by one change. `seen` is a shade that was seen and may be worth adding.
pub(super) fn candidates(landmark: &Landmark, seen: Option<ColorStats>, change: Change) -> Vec<Landmark> {
    let tolerance = landmark.tolerance;
    let with_tolerance = |tolerance: ColorStats| Landmark { tolerance, ..landmark.clone() };
    let scaled = |values: [f32; 3], factor: f32, most: f32| values.map(|value| (value * factor).min(most));
    match change {
        Change::Nothing => Vec::new(),
        Change::Window => SIDES
            .into_iter()
            .map(WindowPx::square)
            .filter(|window_px| *window_px != landmark.window_px)
            .map(|window_px| Landmark { window_px, ..landmark.clone() })
            .collect(),
        Change::MeanTolerance => FACTORS
            .map(|factor| {
                let mean = scaled(tolerance.mean, factor, MAX_MEAN);
                with_tolerance(ColorStats { mean, ..tolerance })
            })
            .to_vec(),
        Change::VarianceTolerance => FACTORS
            .map(|factor| {
                let variance = scaled(tolerance.variance, factor, MAX_VARIANCE);
                with_tolerance(ColorStats { variance, ..tolerance })
            })
            .to_vec(),
        Change::Shades => other_shades(landmark, seen),
    }
}

/// With the shade that was seen, and without each of the others.
fn other_shades(landmark: &Landmark, seen: Option<ColorStats>) -> Vec<Landmark> {
    let with_shades = |shades| Landmark { shades, ..landmark.clone() };
    let fewer = (0..landmark.shades.len()).filter(|_| landmark.shades.len() > 1).map(|out| {
        let kept = landmark.shades.iter().enumerate().filter(|(at, _)| *at != out);
        with_shades(kept.map(|(_, shade)| *shade).collect())
    });
    let more = seen
        .filter(|_| landmark.shades.len() < MAX_SHADES)
        .map(|shade| with_shades([landmark.shades.as_slice(), &[shade]].concat()));
    more.into_iter().chain(fewer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn landmark(shades: usize) -> Landmark {
        Landmark {
            id: "red".to_owned(),
            revision: 1,
            window_px: WindowPx::square(12),
            shades: (0..shades).map(|at| ColorStats::uniform(at as f32, 0.0)).collect(),
            tolerance: ColorStats::uniform(200.0, 9_000.0),
            shape: vision::ShapeClass::Any,
            size_m: None,
            digest: vision::Digest::default(),
        }
    }

    #[test]
    fn candidates_stay_within_what_a_landmark_may_say() {
        let (landmark, seen) = (landmark(2), Some(ColorStats::uniform(90.0, 4.0)));
        for change in Change::SWEEPS {
            for candidate in candidates(&landmark, seen, change) {
                assert_ne!(candidate, landmark);
                assert!(candidate.tolerance.mean[0] <= MAX_MEAN);
                assert!(candidate.tolerance.variance[0] <= MAX_VARIANCE);
            }
        }
    }

    #[test]
    fn shades_come_and_go_within_their_bounds() {
        let seen = Some(ColorStats::uniform(90.0, 4.0));
        let counts = |shades, seen| -> Vec<usize> {
            candidates(&landmark(shades), seen, Change::Shades).iter().map(|l| l.shades.len()).collect()
        };
        assert_eq!(counts(1, None), [0usize; 0]);
        assert_eq!(counts(1, seen), [2]);
        assert_eq!(counts(3, seen), [4, 2, 2, 2]);
        assert_eq!(counts(MAX_SHADES, seen), [MAX_SHADES - 1; MAX_SHADES]);
    }
}
