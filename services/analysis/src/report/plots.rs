//! Charts of one landmark, as the thesis's Figures 4.6, 4.8 and 4.9.

use vision::SizePx;

use crate::chart::{Axis, Chart, Extent, Mark, Series};

/// What is plotted over the frame number.
pub(super) struct Course {
    /// With its unit.
    pub(super) title: String,
    /// Frame number and value.
    pub(super) measured: Vec<(f64, f64)>,
    /// Frame number and value.
    pub(super) predicted: Vec<(f64, f64)>,
}

/// Measured dots over the predicted line.
pub(super) fn over_frames(course: Course) -> Chart {
    let measured = Series::new("measured", Mark::Dots, course.measured);
    Chart::over_frames(course.title, vec![measured, Series::new("predicted", Mark::Line, course.predicted)])
}

/// The centres in the picture's plane.
pub(super) fn path(title: &str, size: SizePx, centres: Vec<(f64, f64)>) -> Chart {
    let first = centres.first().copied().into_iter().collect();
    Chart {
        title: title.to_owned(),
        x: Axis::new("x, px", Extent::Fixed(0.0, f64::from(size.width.max(1)))),
        y: Axis::new("y, px", Extent::Fixed(f64::from(size.height.max(1)), 0.0)),
        series: vec![Series::new("", Mark::Dots, centres), Series::new("", Mark::Rings, first)],
    }
}
