//! Plots of one landmark, as the thesis's Figures 4.6, 4.8 and 4.9.

use plotters::prelude::{
    ChartBuilder, Circle, IntoDrawingArea, IntoFont, LineSeries, PathElement, RGBColor, SVGBackend, WHITE,
};
use plotters::style::Color;
use vision::SizePx;

use super::ReportError;

const MEASURED: RGBColor = RGBColor(20, 86, 184);
const PREDICTED: RGBColor = RGBColor(214, 96, 20);
const SOFT: RGBColor = RGBColor(91, 102, 117);
const GRID: RGBColor = RGBColor(228, 232, 238);
/// Points of a series; of a longer one every so many-th is drawn.
const MOST_POINTS: usize = 1_500;

/// What is plotted over the frame number.
pub(super) struct Series {
    /// With its unit.
    pub(super) title: String,
    /// Frame number and value.
    pub(super) measured: Vec<(f64, f64)>,
    /// Frame number and value.
    pub(super) predicted: Vec<(f64, f64)>,
}

/// Measured dots over the predicted line.
pub(super) fn over_frames(series: &Series) -> Result<String, ReportError> {
    let mut svg = String::new();
    draw_series(series, &mut svg).map_err(|error| ReportError::Plot(error.to_string()))?;
    Ok(svg)
}

/// The centres in the picture's plane.
pub(super) fn path(title: &str, size: SizePx, centres: &[(f64, f64)]) -> Result<String, ReportError> {
    let mut svg = String::new();
    draw_path(title, size, centres, &mut svg).map_err(|error| ReportError::Plot(error.to_string()))?;
    Ok(svg)
}

fn draw_series(series: &Series, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (560, 300)).into_drawing_area();
    root.fill(&WHITE)?;
    let all = || series.measured.iter().chain(&series.predicted);
    let (x, y) = (range(all().map(|point| point.0)), padded(range(all().map(|point| point.1))));
    let mut chart = ChartBuilder::on(&root)
        .caption(&series.title, ("sans-serif", 15).into_font().color(&SOFT))
        .margin(10)
        .x_label_area_size(34)
        .y_label_area_size(48)
        .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .axis_style(SOFT)
        .label_style(("sans-serif", 12).into_font().color(&SOFT))
        .x_desc("frame")
        .x_labels(7)
        .y_labels(6)
        .x_label_formatter(&|value| format!("{value:.0}"))
        .y_label_formatter(&|value| label(*value, y))
        .draw()?;
    chart
        .draw_series(LineSeries::new(thinned(&series.predicted), PREDICTED.stroke_width(1)))?
        .label("predicted")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 14, y)], PREDICTED.stroke_width(2)));
    chart
        .draw_series(thinned(&series.measured).map(|point| Circle::new(point, 2, MEASURED.filled())))?
        .label("measured")
        .legend(|(x, y)| Circle::new((x + 7, y), 3, MEASURED.filled()));
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.8))
        .border_style(GRID)
        .label_font(("sans-serif", 12).into_font().color(&SOFT))
        .draw()?;
    Ok(root.present()?)
}

fn draw_path(
    title: &str,
    size: SizePx,
    centres: &[(f64, f64)],
    svg: &mut String,
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (560, 300)).into_drawing_area();
    root.fill(&WHITE)?;
    let (width, height) = (f64::from(size.width.max(1)), f64::from(size.height.max(1)));
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 15).into_font().color(&SOFT))
        .margin(10)
        .x_label_area_size(34)
        .y_label_area_size(48)
        .build_cartesian_2d(0.0..width, height..0.0)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .axis_style(SOFT)
        .label_style(("sans-serif", 12).into_font().color(&SOFT))
        .x_desc("x, px")
        .y_desc("y, px")
        .x_label_formatter(&|value| format!("{value:.0}"))
        .y_label_formatter(&|value| format!("{value:.0}"))
        .draw()?;
    chart.draw_series(LineSeries::new(thinned(centres), MEASURED.mix(0.35)))?;
    chart.draw_series(thinned(centres).map(|point| Circle::new(point, 2, MEASURED.filled())))?;
    if let Some(first) = centres.first() {
        chart.draw_series([Circle::new(*first, 5, PREDICTED.stroke_width(2))])?;
    }
    Ok(root.present()?)
}

fn thinned(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    points.iter().copied().step_by(points.len().div_ceil(MOST_POINTS).max(1))
}

/// Least and greatest, made apart where there is one value or none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (least, most) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
    match least < most {
        true => (least, most),
        false if least.is_finite() => (least - 1.0, least + 1.0),
        false => (0.0, 1.0),
    }
}

fn padded((least, most): (f64, f64)) -> (f64, f64) {
    let pad = 0.05 * (most - least);
    (least - pad, most + pad)
}

/// As many places as the axis needs.
fn label(value: f64, (least, most): (f64, f64)) -> String {
    match most - least {
        span if span >= 10.0 => format!("{value:.0}"),
        span if span >= 1.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_without_sightings_is_plotted_too() {
        let empty = Series { title: "X".to_owned(), measured: Vec::new(), predicted: Vec::new() };
        assert!(over_frames(&empty).unwrap().starts_with("<svg"));
        assert!(path("centre", SizePx { width: 64, height: 48 }, &[]).unwrap().contains("</svg>"));
    }

    #[test]
    fn long_drives_are_thinned() {
        let long: Vec<(f64, f64)> = (0..10_000).map(|at| (f64::from(at), 0.0)).collect();
        assert!(thinned(&long).count() <= MOST_POINTS);
    }
}
