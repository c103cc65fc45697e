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

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let picture =
        noisy(&Plane::from_fn(SIZE, |x, y| ((x / 8 + y / 8) % 2 * 200) as f32), Noise::Gaussian(10.0));
    let (mut space, mut fourier) = (Vec::new(), Vec::new());
    let mut furthest: f64 = 0.0;
    for side in SIDES {
        let kernel = Plane::from_fn(SizePx { width: side, height: side }, |x, y| 1.0 / (1 + x + y) as f32);
        let (direct, direct_ms) = timed(|| convolve(&picture, &kernel, Extent::Same));
        let mut prepared = FourierConvolution::new(&kernel, SIZE, Extent::Same)?;
        prepared.apply(&picture);
        let (transformed, transformed_ms) = timed(|| prepared.apply(&picture));
        let most = direct.values().iter().fold(0.0_f32, |most, value| most.max(value.abs()));
        let pairs = direct.values().iter().zip(transformed.values());
        furthest = furthest.max(pairs.map(|(a, b)| f64::from((a - b).abs() / most)).fold(0.0, f64::max));
        space.push((f64::from(side), direct_ms));
        fourier.push((f64::from(side), transformed_ms));
    }
    let faster_from =
        space.iter().zip(&fourier).find(|(space, fourier)| fourier.1 < space.1).map(|(space, _)| space.0);
    let mut account = Account::default();
    account.compare(
        "largest difference of the two",
        Thesis::Number(0.0),
        furthest,
        "of the largest value",
        "equations 2.5 and 2.8 give the same, without the factor 1/MN of 2.5",
    );
    account.compare(
        "kernel side from which Fourier is faster",
        Thesis::Words("always easier and faster"),
        faster_from,
        "px",
        "of those tried; this program on this machine, 320×240 pixels",
    );
    for at in [0, SIDES.len() - 1] {
        let factor = space[at].1 / fourier[at].1;
        account.compare(
            format!("time in space over Fourier, {0}×{0}", SIDES[at]),
            Thesis::Words("above 1"),
            factor,
            "times",
            "",
        );
    }
    account.sentence = match faster_from {
        Some(side) => format!(
            "Both ways agree; the Fourier transform is faster for kernels of {side:.0}×{side:.0} pixels and more, not for the 3×3 kernels of the thesis's edge detectors."
        ),
        None => "Both ways agree; the Fourier transform was not faster for any kernel tried.".to_owned(),
    };
    account.chart(&Chart {
        title: "Convolution of 320×240 pixels, CPU ms".to_owned(),
        x: Axis::new("side of the kernel, px", Shown::Data),
        y: Axis::new("ms", Shown::DataFromZero),
        series: vec![
            Series::new("in space", Mark::Line, space),
            Series::new("by Fourier", Mark::Line, fourier),
        ],
    })?;
    Ok(account)
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
