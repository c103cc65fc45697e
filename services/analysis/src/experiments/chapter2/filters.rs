//! Figure 2.1: low-pass and median filter on a noisy picture of letters.

use vision::SizePx;
use vision::methods::gradient::{Operator, gradient};
use vision::methods::low_pass::low_pass;
use vision::methods::{Border, Plane, median};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::noise::{Noise, noisy};
use crate::experiments::picture::{grey, side};
use crate::experiments::scene::letters;
use crate::experiments::{ExperimentError, Lab};

/// Levels of the Gaussian noise.
const SIGMA: f32 = 25.0;
/// Part of the pixels that impulses hit.
const IMPULSES: f64 = 0.05;
/// Differences above this many levels are noise that is left.
const LEFT_LEVELS: f32 = 20.0;

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let clean = letters();
    let mut account = Account::default();
    let mut told = Vec::new();
    for (noise, name) in [(Noise::Gaussian(SIGMA), "Gaussian"), (Noise::Impulses(IMPULSES), "impulse")] {
        let input = noisy(&clean, noise);
        let low = low_pass(&input, side(5), side(5), Border::Nearest);
        let middle = median(&input, side(2), side(2), Border::Nearest);
        let wide = median(&input, side(3), side(3), Border::Nearest);
        for (picture, what) in [(&input, "Input"), (&low, "Low-pass 5×5"), (&middle, "Median 2×2")] {
            account.picture(&grey(picture, 0.0, 255.0)?, format!("{what}, {name} noise"))?;
        }
        let before = flat_noise(&clean, &input);
        let mut filtered = |filter: &str, output: &Plane, said: Thesis| {
            let left = flat_noise(&clean, output) / before;
            let note = "away from edges";
            account.compare(format!("{name} noise left by {filter}"), said, left, "of its RMS", note);
            let note = "mean Sobel magnitude on the letters' edges";
            let quantity = format!("edge slope after {filter}, {name} noise");
            account.compare(quantity, Thesis::Silent, slope(&clean, output), "of the true one", note);
            left
        };
        filtered("low-pass 5×5", &low, Thesis::Words("noise reduced, edges blurred"));
        let left = filtered("median 2×2", &middle, Thesis::Words("all of the noise removed"));
        filtered("median 3×3", &wide, Thesis::Silent);
        let specks = specks(&clean, &middle);
        let note = "more than 20 levels off, away from edges";
        account.compare(
            format!("{name} specks after median 2×2"),
            Thesis::Number(0.0),
            specks,
            "of pixels",
            note,
        );
        let (left, specks) = (100.0 * left, 100.0 * specks);
        told.push(format!(
            "{left:.0} % of the {name} noise's RMS and {specks:.1} % of the pixels more than 20 levels off"
        ));
    }
    account.sentence = format!(
        "The thesis's 2×2 median, said to remove all of the noise, leaves {}. The kind of noise matters, which the thesis \
         calls Gaussian in the figure and impulse noise in the text.",
        told.join(", and ")
    );
    Ok(account)
}

/// Whether nothing within two pixels differs: no edge is near.
fn is_flat(clean: &Plane, x: u32, y: u32) -> bool {
    let SizePx { width, height } = clean.size();
    let here = clean.get(x, y);
    let (columns, rows) = (x.saturating_sub(3)..(x + 4).min(width), y.saturating_sub(3)..(y + 4).min(height));
    rows.into_iter().all(|row| columns.clone().all(|column| clean.get(column, row) == here))
}

fn flat_errors(clean: &Plane, output: &Plane) -> Vec<f32> {
    let SizePx { width, height } = clean.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    places.filter(|&(x, y)| is_flat(clean, x, y)).map(|(x, y)| output.get(x, y) - clean.get(x, y)).collect()
}

fn flat_noise(clean: &Plane, output: &Plane) -> f64 {
    let errors = flat_errors(clean, output);
    (errors.iter().map(|error| f64::from(error * error)).sum::<f64>() / errors.len().max(1) as f64).sqrt()
}

fn specks(clean: &Plane, output: &Plane) -> f64 {
    let errors = flat_errors(clean, output);
    errors.iter().filter(|error| error.abs() > LEFT_LEVELS).count() as f64 / errors.len().max(1) as f64
}

/// The mean gradient on the true edges, as a part of the true one there.
fn slope(clean: &Plane, output: &Plane) -> f64 {
    let magnitude = |plane: &Plane| gradient(plane, Operator::Sobel, Border::Nearest).magnitude();
    let (true_one, ours) = (magnitude(clean), magnitude(output));
    let (mut sum, mut true_sum) = (0.0, 0.0);
    for (&is, &was) in ours.values().iter().zip(true_one.values()) {
        if was > 0.0 {
            sum += f64::from(is);
            true_sum += f64::from(was);
        }
    }
    sum / true_sum
}
