//! Figure 2.2: Sobel's gradients of rectangles; and what their weights do about noise.

use vision::methods::gradient::{Operator, gradient};
use vision::methods::{Border, Intensity, Plane};
use vision::{RectPx, SizePx};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::noise::{Noise, noisy};
use crate::experiments::picture::grey;
use crate::experiments::scene::rectangles;
use crate::experiments::{ExperimentError, Lab};
use crate::figures::Spread;

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let (frame, rects) = rectangles()?;
    let plane = Plane::of(&frame, Intensity::Luma);
    let sobel = gradient(&plane, Operator::Sobel, Border::Nearest);
    let magnitude = sobel.magnitude();
    let mut account = Account::default();
    account.picture(&grey(&plane, 0.0, 255.0)?, "Input, after Fig 2.2")?;
    account.picture(&grey(&sobel.x, -500.0, 500.0)?, "∂f/∂x: dark and bright are negative and positive")?;
    account.picture(&grey(&sobel.y, -500.0, 500.0)?, "∂f/∂y")?;
    account.picture(&grey(&magnitude, 0.0, 500.0)?, "Magnitude, equation 2.13")?;
    let on_edges = on_edges(&magnitude, &rects);
    account.compare(
        "gradient within a pixel of an edge",
        Thesis::Words("edges are shown"),
        on_edges,
        "of its sum",
        "",
    );
    let mut told = Vec::new();
    for (operator, name, step) in [
        (Operator::Sobel, "Sobel", 4.0),
        (Operator::Prewitt, "Prewitt", 3.0),
        (Operator::Roberts, "Roberts", 1.0),
    ] {
        let noise = noise_response(operator) / step;
        let thesis = if operator == Operator::Sobel {
            Thesis::Words("smoother for its weight of 2")
        } else {
            Thesis::Silent
        };
        account.compare(
            format!("{name}'s answer to noise"),
            thesis,
            noise,
            "of that to a step",
            "both of one level",
        );
        told.push(format!("{name} {noise:.2}"));
    }
    account.sentence = format!(
        "{:.0} % of Sobel's gradient lies within a pixel of a true edge. Noise is answered with, as a part of the answer to a \
         step of the same size: {}. The thesis says that Sobel's weight of 2 makes it smoother.",
        100.0 * on_edges,
        told.join(", ")
    );
    Ok(account)
}

/// The part of the gradient that lies within a pixel of a rectangle's border.
fn on_edges(magnitude: &Plane, rects: &[RectPx]) -> f64 {
    let near = |x: u32, y: u32| rects.iter().any(|rect| is_on_border(rect, x, y));
    let (mut on, mut all) = (0.0, 0.0);
    for y in 0..magnitude.height() {
        for x in 0..magnitude.width() {
            let value = f64::from(magnitude.get(x, y));
            all += value;
            on += if near(x, y) { value } else { 0.0 };
        }
    }
    on / all
}

fn is_on_border(rect: &RectPx, x: u32, y: u32) -> bool {
    let within = |at: u32, start: u32, length: u32| at + 1 >= start && at <= start + length;
    let inside = |at: u32, start: u32, length: u32| at > start && at + 2 < start + length + 1;
    within(x, rect.x, rect.width)
        && within(y, rect.y, rect.height)
        && !(inside(x, rect.x, rect.width) && inside(y, rect.y, rect.height))
}

/// Standard deviation of the derivative along x of noise of one level.
fn noise_response(operator: Operator) -> f64 {
    let grey = Plane::from_fn(SizePx { width: 256, height: 256 }, |_, _| 128.0);
    let answer = gradient(&noisy(&grey, Noise::Gaussian(1.0)), operator, Border::Wrap);
    let values: Vec<f64> = answer.x.values().iter().map(|value| f64::from(*value)).collect();
    Spread::of(&values).map_or(f64::NAN, |spread| spread.standard_deviation)
}
