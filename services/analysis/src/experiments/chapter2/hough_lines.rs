//! Figure 2.5: the Hough transform of a picture and its inverse.

use vision::RectPx;

use crate::experiments::account::{Account, Thesis};
use crate::experiments::edges::Lines;
use crate::experiments::picture::heat;
use crate::experiments::scene::rectangles;
use crate::experiments::{ExperimentError, Lab};

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let (frame, rects) = rectangles()?;
    let lines = Lines::of(&frame, 4 * rects.len());
    let found = rects.iter().flat_map(sides).filter(|side| lines.cover(*side)).count();
    let mut account = Account::default();
    let sides = 4 * rects.len();
    account.compare(
        "sides found",
        Thesis::Words("lines are extracted"),
        found as f64,
        "sides",
        format!("of {sides}; at least half covered by segments of the inverse transform"),
    );
    account.compare("segments", Thesis::Silent, lines.segments().len() as f64, "", "");
    account.sentence = format!(
        "The inverse transform finds {found} of the {sides} sides of the rectangles, in {} segments.",
        lines.segments().len()
    );
    account.picture(&frame, "Input, after Fig 2.5 a")?;
    account.picture(
        &heat(&lines.straight.votes.plane())?,
        "Parameter space: θ down from 0° to 180°, ρ to the right",
    )?;
    account.picture(&lines.drawn_over(&frame)?, "Segments of the inverse transform")?;
    Ok(account)
}

/// The four sides of a rectangle, as thin rectangles.
pub(in crate::experiments) fn sides(rect: &RectPx) -> [RectPx; 4] {
    let RectPx { x, y, width, height } = *rect;
    [
        RectPx { x, y, width, height: 1 },
        RectPx { x, y: y + height - 1, width, height: 1 },
        RectPx { x, y, width: 1, height },
        RectPx { x: x + width - 1, y, width: 1, height },
    ]
}
