//! Figure 2.7: the barber's pole turns sideways, and its stripes are seen to climb.

use vision::methods::{HornSchunck, Plane};
use vision::{RectPx, SizePx};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::picture::{arrows, grey};
use crate::experiments::{ExperimentError, Lab};

const SIZE: SizePx = SizePx { width: 96, height: 96 };
/// Distance of the stripes along a row and down a column, px.
const STRIPES: (f32, f32) = (32.0, 24.0);
/// How far the pole's surface moves to the right between two pictures, px.
const TURN_PX: f32 = 1.0;

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let (first, second) = (pole(0.0), pole(TURN_PX));
    let flow = HornSchunck::default().flow(&first, &second)?;
    let middle = RectPx { x: 24, y: 24, width: 48, height: 48 };
    let (u, v) = flow.mean_px(middle).unwrap_or_default();
    let seen_degrees = f64::from(-v).atan2(f64::from(u)).to_degrees();
    // Along the normal of the stripes, equation 2.27.
    let (kx, ky) = (1.0 / STRIPES.0, 1.0 / STRIPES.1);
    let normal_degrees = f64::from(ky).atan2(f64::from(kx)).to_degrees();
    let mut account = Account::default();
    account.compare(
        "true direction",
        Thesis::Words("left to right"),
        0.0,
        "degrees above the row",
        "the pole's surface moves along rows: by construction",
    );
    account.compare(
        "seen direction",
        Thesis::Words("up"),
        seen_degrees,
        "degrees above the row",
        "mean flow of Horn and Schunck over the pole's middle",
    );
    account.compare(
        "normal of the stripes",
        Thesis::Silent,
        normal_degrees,
        "degrees above the row",
        "the brightness gradient, along which equation 2.27 measures",
    );
    account.sentence = format!(
        "The surface moves to the right, but the flow points {seen_degrees:.0}° upwards: along the normal of the stripes, which \
         stands at {normal_degrees:.0}°. The aperture effect is as the thesis says, and smoothness does not undo it here."
    );
    account.picture(&grey(&first, 0.0, 255.0)?, "The pole, after Fig 2.7")?;
    account.picture(&arrows(&first, &flow, 8, 6.0)?, "Flow, six times as long as it is")?;
    Ok(account)
}

/// Stripes that rise to the right, moved to the right by `turned` pixels.
fn pole(turned: f32) -> Plane {
    Plane::from_fn(SIZE, |x, y| {
        let phase = (x as f32 - turned) / STRIPES.0 - y as f32 / STRIPES.1;
        127.0 + 100.0 * (std::f32::consts::TAU * phase).sin()
    })
}
