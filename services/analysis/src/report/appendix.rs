//! The table of the thesis's Appendices B and C: a row for each frame.

use crate::drive::CameraDrive;
use crate::figures::observations;
use crate::page::{Page, escaped};

/// Rows of a table; the rest of a longer drive is for `waymark recording export`.
const MOST_ROWS: usize = 5_000;

/// Writes the table of one landmark. Areas are those of the mask on the doubled grid, as the thesis has them; where it
/// prints zeros, the reason of the miss stands here.
pub(super) fn write(page: &mut Page, drive: &CameraDrive, id: &str) {
    let frames = observations(drive, id).count();
    page.raw(&format!("<details><summary>Frame by frame, as Appendix B: {}</summary>", escaped(id)));
    let rows = observations(drive, id).take(MOST_ROWS).map(|seen| {
        let number = seen.frame.number.map_or_else(|| "–".to_owned(), |number| number.to_string());
        match &seen.best.result {
            Ok(sighting) => vec![
                number,
                format!("{:.2}", sighting.centroid.x),
                format!("{:.2}", sighting.centroid.y),
                format!("{:.2}", sighting.mask_area_2x),
                format!("{:.1}", sighting.area_px2),
                format!("{:.2}", sighting.score),
                String::new(),
            ],
            Err(miss) => {
                let mut row = vec![number];
                row.resize(6, "–".to_owned());
                row.push(miss.name().replace('_', " "));
                row
            }
        }
    });
    page.table("", &["Frame", "X_pos", "Y_pos", "Area", "area, px²", "score", "miss"], rows);
    if frames > MOST_ROWS {
        page.paragraph(&format!(
            "The first {MOST_ROWS} of {frames} frames; all of them: waymark recording export"
        ));
    }
    page.raw("</details>");
}
