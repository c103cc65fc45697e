//! Figures 2.3 and 2.4: points on a line, and the waves that they are in the parameter space of the Hough transform.

use std::f64::consts::PI;

use vision::BitMask;
use vision::methods::HoughTransform;
use vision::methods::hough::Peaks;

use crate::chart::{Axis, Chart, Extent, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::{ExperimentError, Lab};

/// Three points on one line and two beside it; pixel numbers.
const POINTS: [(u32, u32); 5] = [(20, 28), (88, 96), (156, 164), (48, 136), (152, 40)];
const SIDE: u32 = 192;

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let mut mask = BitMask::new(SIDE, SIDE);
    POINTS.iter().for_each(|&(x, y)| mask.set(x, y));
    let lines = HoughTransform::default().votes(&mask).lines(&Peaks {
        least_votes: 2,
        most_lines: 1,
        ..Peaks::default()
    });
    let best = lines.first().copied().unwrap_or_default();
    let mut account = Account::default();
    account.compare(
        "waves through the fullest cell",
        Thesis::Number(3.0),
        f64::from(best.votes),
        "",
        "as many as there are points on the line",
    );
    let off = (f64::from(best.theta_rad).to_degrees() - 135.0).abs();
    account.compare(
        "error of its angle",
        Thesis::Silent,
        off,
        "degrees",
        "the three points lie on y = x + 8, whose normal is at 135°",
    );
    account.sentence = format!(
        "Each point is a wave; {} of them cross in one cell, whose line is {off:.2}° off the one that the points were put on.",
        best.votes
    );
    let points = POINTS.iter().map(|&(x, y)| (f64::from(x), f64::from(y))).collect();
    account.chart(&Chart {
        title: "Points in the picture (Fig 2.3)".to_owned(),
        x: Axis::new("x", Extent::Fixed(0.0, SIDE.into())),
        y: Axis::new("y", Extent::Fixed(0.0, SIDE.into())),
        series: vec![
            Series::new("", Mark::Rings, points),
            Series::new("", Mark::Line, vec![(8.0, 16.0), (176.0, 184.0)]),
        ],
    })?;
    account.chart(&Chart {
        title: "The same in the parameter space (Fig 2.4)".to_owned(),
        x: Axis::new("θ, degrees", Extent::Fixed(0.0, 180.0)),
        y: Axis::new("ρ, px", Extent::Data),
        series: POINTS.iter().map(|&point| Series::new("", Mark::Line, wave(point))).collect(),
    })?;
    Ok(account)
}

/// ρ = x cos θ + y sin θ (equation 2.19).
fn wave((x, y): (u32, u32)) -> Vec<(f64, f64)> {
    let at = |degrees: u32| {
        let (sin, cos) = (f64::from(degrees) * PI / 180.0).sin_cos();
        (f64::from(degrees), f64::from(x) * cos + f64::from(y) * sin)
    };
    (0..=180).step_by(2).map(at).collect()
}
