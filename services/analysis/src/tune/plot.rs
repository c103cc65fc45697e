//! What each trial found against what it claimed falsely, as a picture.

use plotters::prelude::*;

use super::{Change, Trial};

/// Columns and rows of the picture, px.
const SIZE_PX: (u32, u32) = (760, 520);
/// Parts of the axes that stay free around the points.
const MARGIN: f64 = 0.05;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[error("the plot cannot be drawn: {0}")]
pub struct PlotError(String);

/// Draws all `trials` as SVG: a mark for each, by what it changed, and a ring around `best`.
///
/// # Errors
/// When the plotting library refuses.
pub fn svg(trials: &[Trial], best: &Trial) -> Result<String, PlotError> {
    let mut text = String::new();
    draw(&mut text, trials, best).map_err(|error| PlotError(error.to_string()))?;
    Ok(text)
}

fn draw(text: &mut String, trials: &[Trial], best: &Trial) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(text, SIZE_PX).into_drawing_area();
    root.fill(&WHITE)?;
    let (false_range, found_range) = (around(trials, |t| t.false_rate), around(trials, |t| t.detection_rate));
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(false_range, found_range)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("frames with a false claim, %")
        .y_desc("found where it is visible, %")
        .label_style(("sans-serif", 14))
        .draw()?;
    for (change, name, colour) in KINDS {
        let points = trials.iter().filter(|trial| trial.change == change).map(at);
        chart
            .draw_series(points.map(|point| Circle::new(point, 4, colour.filled())))?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, colour.filled()));
    }
    chart
        .draw_series([Circle::new(at(best), 9, BLACK.stroke_width(2))])?
        .label("best")
        .legend(|(x, y)| Circle::new((x + 8, y), 6, BLACK.stroke_width(2)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 14))
        .draw()?;
    root.present()?;
    Ok(())
}

/// Each kind of trial: its name in the legend, and a colour that the colour-blind tell from the others (Okabe, Ito).
const KINDS: [(Change, &str, RGBColor); 5] = [
    (Change::Nothing, "as given", BLACK),
    (Change::Window, "window", RGBColor(0, 114, 178)),
    (Change::MeanTolerance, "tolerance of the means", RGBColor(230, 159, 0)),
    (Change::VarianceTolerance, "tolerance of the variances", RGBColor(0, 158, 115)),
    (Change::Shades, "shades", RGBColor(204, 121, 167)),
];

fn at(trial: &Trial) -> (f64, f64) {
    (100.0 * trial.false_rate, 100.0 * trial.detection_rate)
}

/// A range in per cent that holds `value` of every trial, never empty.
fn around(trials: &[Trial], value: impl Fn(&Trial) -> f64) -> std::ops::Range<f64> {
    let percents = trials.iter().map(|trial| 100.0 * value(trial));
    let (least, most) =
        percents.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), p| (least.min(p), most.max(p)));
    let (least, most) = if least <= most { (least, most) } else { (0.0, 100.0) };
    let margin = MARGIN * (most - least).max(1.0);
    (least - margin)..(most + margin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vision::{ColorStats, Landmark, WindowPx};

    #[test]
    fn every_trial_is_a_mark_and_the_best_has_a_ring() {
        let landmark = Landmark {
            id: "red".to_owned(),
            revision: 1,
            window_px: WindowPx::square(12),
            shades: vec![ColorStats::default()],
            tolerance: ColorStats::uniform(20.0, 90.0),
            shape: vision::ShapeClass::Any,
            size_m: None,
            digest: vision::Digest::default(),
        };
        let trial = |change, detection_rate, false_rate| Trial {
            change,
            landmark: landmark.clone(),
            detection_rate,
            false_rate,
            furthest: None,
        };
        let trials = [trial(Change::Nothing, 0.7, 0.0), trial(Change::Window, 0.9, 0.01)];
        let picture = svg(&trials, &trials[1]).unwrap();
        // One mark each, one in the legend of each kind; the ring and its own.
        assert_eq!(picture.matches("<circle").count(), 2 + KINDS.len() + 2);
        assert!(svg(&trials[..1], &trials[0]).is_ok(), "a single point has a range too");
    }
}
