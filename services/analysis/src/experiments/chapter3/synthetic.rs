//! Section 3.1, Figures 3.1 to 3.3: the synthetic picture.

use vision::RectPx;
use vision::methods::Ncc;
use vision::methods::ncc::NccOptions;

use crate::experiments::account::{Account, Thesis};
use crate::experiments::chapter2::correlation::second_peak;
use crate::experiments::chapter2::hough_lines::sides;
use crate::experiments::edges::Lines;
use crate::experiments::picture::{grey, heat};
use crate::experiments::scene::synthetic;
use crate::experiments::{ExperimentError, Lab};
use crate::thumbnail::part;

/// Strongest lines that are taken.
const LINES: usize = 10;

/// Figures 3.1 and 3.2.
pub(in crate::experiments) fn edges_and_lines(_: &Lab) -> Result<Account, ExperimentError> {
    let scene = synthetic()?;
    let lines = Lines::of(&scene.frame, LINES);
    let found = |rect: &RectPx| sides(rect).into_iter().filter(|side| lines.cover(*side)).count();
    let small = found(&scene.block);
    let large: usize = scene.others.iter().map(found).sum();
    let mut account = Account::default();
    account.compare(
        "sides of the larger blocks found",
        Thesis::Words("the longest lines"),
        large as f64,
        "of 8",
        format!("among the {LINES} strongest lines"),
    );
    account.compare("sides of the small block found", Thesis::Number(0.0), small as f64, "of 4", "");
    account.sentence = format!(
        "The {LINES} strongest lines cover {large} of the 8 sides of the larger blocks and {small} of the small block's 4: \
         votes count length, so small objects lose."
    );
    account.picture(&scene.frame, "The synthetic picture, after Fig 3.1")?;
    account.picture(&grey(&lines.straight.magnitude, 0.0, 800.0)?, "Sobel's magnitude, after Fig 3.2 a")?;
    account.picture(&lines.drawn_over(&scene.frame)?, "The strongest lines, after Fig 3.2 b")?;
    Ok(account)
}

/// Figure 3.3.
pub(in crate::experiments) fn correlation(_: &Lab) -> Result<Account, ExperimentError> {
    let scene = synthetic()?;
    let RectPx { x, y, width, height } = scene.block;
    // A block of one colour has no variance: a rim of background belongs to the template.
    let template = RectPx { x: x - 2, y: y - 2, width: width + 4, height: height + 4 };
    let mut ncc = Ncc::new(&part(&scene.frame, template), &NccOptions::default())?;
    let surface = ncc.surface(&scene.frame, None).clone();
    let (at_x, at_y, peak) = surface.maximum().unwrap_or_default();
    let off = f64::from(at_x.abs_diff(template.x)).hypot(f64::from(at_y.abs_diff(template.y)));
    let second = f64::from(second_peak(&surface, at_x, at_y));
    let mut account = Account::default();
    account.compare("highest coefficient", Thesis::Number(1.0), f64::from(peak), "", "");
    account.compare(
        "its distance from the block",
        Thesis::Words("near the middle of the block"),
        off,
        "px",
        "",
    );
    account.compare(
        "highest elsewhere",
        Thesis::Words("a lower group at the red line"),
        second,
        "",
        "more than ten pixels away",
    );
    account.sentence = format!(
        "Without noise the highest coefficient, {peak:.3}, lies {off:.0} px off the block, and {second:.2} is the highest elsewhere."
    );
    account.picture(&heat(&surface)?, "Coefficients, after Fig 3.3: blue is the least, red the greatest")?;
    Ok(account)
}
