//! Section 2.2: convolution in space and by Fourier transforms (equations 2.5 to 2.8).

use vision::SizePx;
use vision::methods::convolve::{FourierConvolution, convolve};
use vision::methods::{Extent, Plane};

use crate::chart::{Axis, Chart, Extent as Shown, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::noise::{Noise, noisy};
use crate::experiments::{ExperimentError, Lab};
use crate::stage_times::thread_cpu_ns;

const SIZE: SizePx = SizePx { width: 320, height: 240 };
const SIDES: [u32; 6] = [3, 5, 9, 15, 23, 31];

/// Both ways with one kernel.
struct Trial {
    side: u32,
    space_ms: f64,
    fourier_ms: f64,
    /// Largest difference of the two, as a part of the largest value.
    difference: f64,
}

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let squares = Plane::from_fn(SIZE, |x, y| ((x / 8 + y / 8) % 2 * 200) as f32);
    let picture = noisy(&squares, Noise::Gaussian(10.0));
    let trials: Vec<Trial> = SIDES.iter().map(|&side| trial(&picture, side)).collect::<Result<_, _>>()?;
    let furthest = trials.iter().map(|trial| trial.difference).fold(0.0, f64::max);
    let faster_from =
        trials.iter().find(|trial| trial.fourier_ms < trial.space_ms).map(|trial| f64::from(trial.side));
    let mut account = Account::default();
    let note = "equations 2.5 and 2.8 give the same, without the factor 1/MN of 2.5";
    account.compare(
        "largest difference of the two",
        Thesis::Number(0.0),
        furthest,
        "of the largest value",
        note,
    );
    let note = "of those tried; this program on this machine, 320×240 pixels";
    let said = Thesis::Words("always easier and faster");
    account.compare("kernel side from which Fourier is faster", said, faster_from, "px", note);
    for trial in trials.first().into_iter().chain(trials.last()) {
        let quantity = format!("time in space over Fourier, {0}×{0}", trial.side);
        account.compare(quantity, Thesis::Words("above 1"), trial.space_ms / trial.fourier_ms, "times", "");
    }
    account.sentence = match faster_from {
        Some(side) => format!(
            "Both ways agree to {furthest:.0e} of the largest value; of the kernels tried, the Fourier transform is faster \
             from {side:.0}×{side:.0} pixels on. The thesis's edge detectors have 3×3."
        ),
        None => "Both ways agree; the Fourier transform was not faster for any kernel tried.".to_owned(),
    };
    account.chart(&chart(&trials))?;
    Ok(account)
}

fn trial(picture: &Plane, side: u32) -> Result<Trial, ExperimentError> {
    let kernel = Plane::from_fn(SizePx { width: side, height: side }, |x, y| 1.0 / (1 + x + y) as f32);
    let (direct, space_ms) = timed(|| convolve(picture, &kernel, Extent::Same));
    let mut prepared = FourierConvolution::new(&kernel, SIZE, Extent::Same)?;
    prepared.apply(picture);
    let (transformed, fourier_ms) = timed(|| prepared.apply(picture));
    let most = direct.values().iter().fold(0.0_f32, |most, value| most.max(value.abs()));
    let pairs = direct.values().iter().zip(transformed.values());
    let difference = pairs.map(|(a, b)| f64::from((a - b).abs() / most)).fold(0.0, f64::max);
    Ok(Trial { side, space_ms, fourier_ms, difference })
}

fn chart(trials: &[Trial]) -> Chart {
    let points =
        |of: fn(&Trial) -> f64| trials.iter().map(|trial| (f64::from(trial.side), of(trial))).collect();
    Chart {
        title: "Convolution of 320×240 pixels, CPU ms".to_owned(),
        x: Axis::new("side of the kernel, px", Shown::Data),
        y: Axis::new("ms", Shown::DataFromZero),
        series: vec![
            Series::new("in space", Mark::Line, points(|trial| trial.space_ms)),
            Series::new("by Fourier", Mark::Line, points(|trial| trial.fourier_ms)),
        ],
    }
}

/// The best of three times.
fn timed(mut work: impl FnMut() -> Plane) -> (Plane, f64) {
    let mut best = f64::INFINITY;
    let mut result = Plane::default();
    for _ in 0..3 {
        let started_ns = thread_cpu_ns();
        result = work();
        best = best.min((thread_cpu_ns() - started_ns) as f64 * 1e-6);
    }
    (result, best)
}
