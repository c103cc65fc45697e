//! Figure 2.6: what normalised cross correlation gives.

use vision::RectPx;
use vision::methods::ncc::NccOptions;
use vision::methods::{Ncc, Plane};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::picture::{grey, heat};
use crate::experiments::scene::letters;
use crate::experiments::{ExperimentError, Lab};
use crate::thumbnail::part;

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let frame = grey(&letters(), 0.0, 255.0)?;
    let around = RectPx { x: 106, y: 10, width: 32, height: 48 };
    let mut ncc = Ncc::new(&part(&frame, around), &NccOptions::default())?;
    let surface = ncc.surface(&frame, None).clone();
    let mut account = Account::default();
    let (x, y, peak) = surface.maximum().unwrap_or_default();
    let off = f64::from(x.abs_diff(around.x)).hypot(f64::from(y.abs_diff(around.y)));
    account.compare("highest coefficient", Thesis::Number(1.0), f64::from(peak), "", "");
    account.compare("its distance from the template's place", Thesis::Number(0.0), off, "px", "");
    let second = second_peak(&surface, x, y);
    account.compare(
        "second highest peak",
        Thesis::Silent,
        f64::from(second),
        "",
        "more than ten pixels away",
    );
    account.sentence = format!(
        "The surface has its maximum of {peak:.3} where the template was cut, {off:.0} px off; the next peak elsewhere reaches {second:.2}."
    );
    account.picture(&frame, "Input; the template is the letter H")?;
    account.picture(&heat(&surface)?, "Coefficients: blue is the least, red the greatest")?;
    Ok(account)
}

/// The largest value more than ten pixels from (x, y).
pub(in crate::experiments) fn second_peak(surface: &Plane, x: u32, y: u32) -> f32 {
    let mut best = -1.0_f32;
    for row in 0..surface.height() {
        for (column, &value) in (0_u32..).zip(surface.row(row)) {
            if row.abs_diff(y).max(column.abs_diff(x)) > 10 {
                best = best.max(value);
            }
        }
    }
    best
}
