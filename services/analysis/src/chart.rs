//! Charts as SVG: series over two axes. One place decides how all of them look, on pages light and dark.

use std::error::Error;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{
    Cartesian2d, ChartBuilder, ChartContext, Circle, DrawingArea, IntoDrawingArea, IntoFont, LineSeries,
    PathElement, RGBColor, SVGBackend, SeriesLabelPosition, WHITE,
};
use plotters::style::{Color, ShapeStyle};

/// Columns and rows of a chart, px; pages scale it.
const SIZE_PX: (u32, u32) = (560, 300);
/// Points of a series; of a longer one every so many-th is drawn.
const MOST_POINTS: usize = 1_500;

/// The part of the width and of the height that a legend may cover.
const LEGEND_PART: (f64, f64) = (0.3, 0.3);

/// More names than these would cover the data; the page tells them instead.
const MOST_NAMED: usize = 5;

/// Axes and words; the style sheet of the page knows this colour and [`GRID`], and changes them on dark pages.
const SOFT: RGBColor = RGBColor(91, 102, 117);
const GRID: RGBColor = RGBColor(228, 232, 238);

/// The colours of series, which colour-blind readers can tell apart (after Okabe and Ito) and which show on light and
/// on dark paper.
const PALETTE: [RGBColor; 9] = [
    RGBColor(31, 111, 214),
    RGBColor(224, 110, 20),
    RGBColor(0, 150, 110),
    RGBColor(196, 90, 160),
    RGBColor(150, 130, 20),
    RGBColor(60, 165, 220),
    RGBColor(190, 60, 50),
    RGBColor(125, 125, 125),
    RGBColor(110, 80, 200),
];

/// The colour of the series with that number.
pub(crate) fn series_colour(number: usize) -> [u8; 3] {
    let RGBColor(red, green, blue) = PALETTE[number % PALETTE.len()];
    [red, green, blue]
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    /// A dot for each point.
    Dots,
    /// A line through all points.
    Line,
    /// A ring around each point.
    Rings,
    /// A line for each two points.
    Pairs,
}

/// Points that belong together.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Its name in the legend; none where it is empty.
    pub(crate) name: String,
    pub(crate) mark: Mark,
    pub(crate) points: Vec<(f64, f64)>,
}

impl Series {
    pub(crate) fn new(name: impl Into<String>, mark: Mark, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), mark, points }
    }
}

/// Which values an axis shows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Extent {
    /// Those of the data.
    Data,
    /// These, the first at the axis's beginning; the first may be the larger one.
    Fixed(f64, f64),
    /// From zero to the largest value of the data.
    DataFromZero,
}

/// One axis.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// With its unit; empty for none.
    pub(crate) name: String,
    pub(crate) extent: Extent,
}

impl Axis {
    pub(crate) fn new(name: impl Into<String>, extent: Extent) -> Self {
        Self { name: name.into(), extent }
    }
}

/// A chart.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
}

/// A chart that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw the chart `{title}`: {reason}")]
pub struct ChartError {
    title: String,
    reason: String,
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

impl Chart {
    /// A chart of values over frame numbers.
    pub(crate) fn over_frames(title: impl Into<String>, series: Vec<Series>) -> Self {
        Self {
            title: title.into(),
            x: Axis::new("frame", Extent::Data),
            y: Axis::new("", Extent::Data),
            series,
        }
    }

    /// As an SVG element.
    pub(crate) fn svg(&self) -> Result<String, ChartError> {
        let mut svg = String::new();
        let drawn = self.draw(&SVGBackend::with_string(&mut svg, SIZE_PX).into_drawing_area());
        drawn.map_err(|error| ChartError { title: self.title.clone(), reason: error.to_string() })?;
        Ok(svg)
    }

    fn draw(&self, root: &Area<'_>) -> Result<(), Box<dyn Error>> {
        root.fill(&WHITE)?;
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x = extent(&self.x.extent, points().map(|point| point.0), 0.0);
        let y = extent(&self.y.extent, points().map(|point| point.1), 0.05);
        let mut axes = ChartBuilder::on(root)
            .caption(&self.title, ("sans-serif", 15).into_font().color(&SOFT))
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(if self.y.name.is_empty() { 48 } else { 60 })
            .build_cartesian_2d(x.clone(), y.clone())?;
        self.mesh(&mut axes, &x, &y)?;
        for (series, colour) in self.series.iter().zip(PALETTE.iter().cycle()) {
            draw_series(&mut axes, series, *colour)?;
        }
        let named = self.series.iter().filter(|series| !series.name.is_empty()).count();
        if (1..=MOST_NAMED).contains(&named) {
            axes.configure_series_labels()
                .position(self.emptiest_corner(&x, &y))
                .background_style(WHITE.mix(0.8))
                .border_style(GRID)
                .label_font(("sans-serif", 12).into_font().color(&SOFT))
                .draw()?;
        }
        Ok(root.present()?)
    }

    /// Where a legend covers the fewest points; of equals, where one expects it.
    fn emptiest_corner(&self, x: &Range<f64>, y: &Range<f64>) -> SeriesLabelPosition {
        // Parts of the axes' lengths from their beginnings, which may be their larger ends.
        let along = |value: f64, axis: &Range<f64>| (value - axis.start) / (axis.end - axis.start);
        let places: Vec<(f64, f64)> = self
            .series
            .iter()
            .flat_map(|series| thinned(&series.points))
            .map(|(at_x, at_y)| (along(at_x, x), along(at_y, y)))
            .collect();
        let corners = [
            (SeriesLabelPosition::UpperRight, (1.0, 1.0)),
            (SeriesLabelPosition::UpperLeft, (0.0, 1.0)),
            (SeriesLabelPosition::LowerRight, (1.0, 0.0)),
            (SeriesLabelPosition::LowerLeft, (0.0, 0.0)),
        ];
        let covered = |corner: (f64, f64)| {
            let within = |place: &&(f64, f64)| {
                (place.0 - corner.0).abs() <= LEGEND_PART.0 && (place.1 - corner.1).abs() <= LEGEND_PART.1
            };
            places.iter().filter(within).count()
        };
        let fewest = corners.into_iter().min_by_key(|(_, corner)| covered(*corner));
        fewest.map_or(SeriesLabelPosition::UpperRight, |(position, _)| position)
    }

    fn mesh(&self, axes: &mut Axes<'_, '_>, x: &Range<f64>, y: &Range<f64>) -> Result<(), Box<dyn Error>> {
        axes.configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(GRID)
            .axis_style(SOFT)
            .label_style(("sans-serif", 12).into_font().color(&SOFT))
            .x_desc(&self.x.name)
            .y_desc(&self.y.name)
            .x_labels(7)
            .y_labels(6)
            .x_label_formatter(&|value| label(*value, x))
            .y_label_formatter(&|value| label(*value, y))
            .draw()?;
        Ok(())
    }
}

fn draw_series(axes: &mut Axes<'_, '_>, series: &Series, colour: RGBColor) -> Result<(), Box<dyn Error>> {
    let points = || thinned(&series.points);
    let line: ShapeStyle = colour.stroke_width(2);
    let drawn = match series.mark {
        Mark::Line => axes.draw_series(LineSeries::new(points(), line))?,
        Mark::Dots => axes.draw_series(points().map(|point| Circle::new(point, 2, colour.filled())))?,
        Mark::Rings => axes.draw_series(points().map(|point| Circle::new(point, 5, line)))?,
        Mark::Pairs => {
            let pairs = series.points.chunks_exact(2);
            axes.draw_series(pairs.map(|pair| PathElement::new([pair[0], pair[1]], line)))?
        }
    };
    if !series.name.is_empty() {
        drawn.label(&series.name);
        match series.mark {
            Mark::Line | Mark::Pairs => {
                drawn.legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], line));
            }
            Mark::Dots => {
                drawn.legend(move |(x, y)| Circle::new((x + 7, y), 3, colour.filled()));
            }
            Mark::Rings => {
                drawn.legend(move |(x, y)| Circle::new((x + 7, y), 4, line));
            }
        }
    }
    Ok(())
}

fn thinned(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    points.iter().copied().step_by(points.len().div_ceil(MOST_POINTS).max(1))
}

/// What an axis shows; never empty. `pad` is the part of the data's span that stays free on both sides.
fn extent(wanted: &Extent, values: impl Iterator<Item = f64>, pad: f64) -> Range<f64> {
    if let Extent::Fixed(from, to) = *wanted {
        return from..to;
    }
    let (least, most) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
    let (least, most) = match least < most {
        true => (least, most),
        false if least.is_finite() => (least - 1.0, least + 1.0),
        false => (0.0, 1.0),
    };
    let pad = pad * (most - least);
    match wanted {
        Extent::DataFromZero => 0.0..(most + pad).max(f64::MIN_POSITIVE),
        _ => least - pad..most + pad,
    }
}

/// As many places as the axis needs.
fn label(value: f64, axis: &Range<f64>) -> String {
    match (axis.end - axis.start).abs() {
        span if span >= 10.0 => format!("{value:.0}"),
        span if span >= 1.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_without_points_is_drawn_too() {
        let empty = Chart::over_frames("X", vec![Series::new("measured", Mark::Dots, Vec::new())]);
        assert!(empty.svg().unwrap().starts_with("<svg"));
    }

    #[test]
    fn long_series_are_thinned() {
        let long: Vec<(f64, f64)> = (0..10_000).map(|at| (f64::from(at), 0.0)).collect();
        assert!(thinned(&long).count() <= MOST_POINTS);
    }

    #[test]
    fn the_legend_stands_where_it_covers_the_least() {
        let corner = |points: &[(f64, f64)]| {
            let chart = Chart::over_frames("X", vec![Series::new("measured", Mark::Dots, points.to_vec())]);
            format!("{:?}", chart.emptiest_corner(&(0.0..10.0), &(0.0..10.0)))
        };
        assert_eq!(corner(&[]), "UpperRight");
        assert_eq!(corner(&[(9.0, 9.0), (1.0, 1.0)]), "UpperLeft");
        assert_eq!(corner(&[(9.0, 9.0), (1.0, 9.0), (1.0, 1.0)]), "LowerRight");
    }

    #[test]
    fn an_axis_is_never_empty() {
        let of = |values: &[f64]| extent(&Extent::Data, values.iter().copied(), 0.0);
        assert_eq!(of(&[3.0, 3.0]), 2.0..4.0);
        assert_eq!(of(&[f64::NAN]), 0.0..1.0);
        assert_eq!(extent(&Extent::DataFromZero, [4.0, 8.0].into_iter(), 0.0), 0.0..8.0);
        assert_eq!(extent(&Extent::Fixed(9.0, 2.0), [4.0].into_iter(), 0.0), 9.0..2.0);
    }
}
