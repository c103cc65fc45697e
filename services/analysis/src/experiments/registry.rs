//! The list of all experiments, in the order of the thesis.

use super::Place::{Figure, Section, Table};
use super::chapter2::{
    aperture, convolution, correlation, filters, flow, hough_lines, interpolation, parameter_space,
    registration, sobel,
};
use super::chapter3::{acquired, synthetic as synthetic_edges};
use super::chapter4::{
    blocks, disturbances, doubling, green_signs, prediction, printed_tables, random_segments, search_area,
    stop_sign, synthetic, tolerances,
};
use super::{Account, Experiment, ExperimentError, Lab, Place};

const fn experiment(
    place: Place,
    number: &'static str,
    section: &'static str,
    title: &'static str,
    run: fn(&Lab) -> Result<Account, ExperimentError>,
) -> Experiment {
    Experiment { place, number, section, title, run }
}

/// Every experiment.
pub const ALL: &[Experiment] = &[
    experiment(Section, "2.2", "2.2", "Convolution in space and by Fourier transforms", convolution::run),
    experiment(Figure, "2.1", "2.3", "Low-pass and median filter", filters::run),
    experiment(Section, "2.4", "2.4", "Three ways to interpolate", interpolation::run),
    experiment(Figure, "2.2", "2.5", "Sobel's edges, and noise", sobel::run),
    experiment(Figure, "2.4", "2.6", "Points as waves in the parameter space", parameter_space::run),
    experiment(Figure, "2.5", "2.6", "The Hough transform and its inverse", hough_lines::run),
    experiment(Section, "2.7.3", "2.7.3", "Control points and phase correlation", registration::run),
    experiment(Figure, "2.6", "2.7.4", "What cross correlation gives", correlation::run),
    experiment(Figure, "2.7", "2.8", "The barber's pole: the aperture effect", aperture::run),
    experiment(Figure, "2.9", "2.8", "Optical flow of two blocks", flow::blocks),
    experiment(Section, "2.8", "2.8", "Optical flow while the camera moves", flow::moving_camera),
    experiment(
        Figure,
        "3.2",
        "3.1",
        "Edges and lines of the synthetic picture",
        synthetic_edges::edges_and_lines,
    ),
    experiment(
        Figure,
        "3.3",
        "3.1",
        "Cross correlation on the synthetic picture",
        synthetic_edges::correlation,
    ),
    experiment(Figure, "3.5", "3.2.1", "Edges on the rink", acquired::edges),
    experiment(Figure, "3.6", "3.2.2", "Lines on the rink", acquired::lines),
    experiment(Figure, "3.7", "3.2.3", "Cross correlation on the rink", acquired::correlation),
    experiment(Figure, "4.1", "4.0.2", "Random segments and the test of angles", random_segments::run),
    experiment(Table, "4.1", "4.0.4", "The synthetic block's statistics", synthetic::characteristics),
    experiment(Figure, "4.3", "4.0.4", "Registration on the synthetic picture", synthetic::registration),
    experiment(Section, "4.0.3", "4.0.3", "What the doubled resolution does", doubling::run),
    experiment(Figure, "4.4", "4.0.5", "Perpendicular segments of the red block", synthetic::segments),
    experiment(Table, "4.2", "4.0.5", "The red block's statistics", blocks::red_characteristics),
    experiment(Figure, "4.5", "4.0.5", "The red block over 299 frames", blocks::red),
    experiment(
        Figure,
        "4.6",
        "4.0.5",
        "Ten frames of the red block, as printed twice",
        printed_tables::figure,
    ),
    experiment(Table, "4.3", "4.0.5", "The blue block's statistics", blocks::blue_characteristics),
    experiment(Figure, "4.7", "4.0.5", "The blue block over 299 frames", blocks::blue),
    experiment(
        Section,
        "B, C",
        "4.0.5",
        "Appendices B and C: what was found in every frame",
        printed_tables::appendices,
    ),
    experiment(Figure, "4.8", "4.0.6", "Prediction of the red block by four methods", prediction::red_figure),
    experiment(Table, "4.4", "4.0.6", "Prediction error of the red block", prediction::red_table),
    experiment(
        Figure,
        "4.9",
        "4.0.6",
        "Prediction of the blue block by four methods",
        prediction::blue_figure,
    ),
    experiment(Table, "4.5", "4.0.6", "Prediction error of the blue block", prediction::blue_table),
    experiment(Section, "4.0.6", "4.0.6", "Searching near the prediction", search_area::run),
    experiment(Figure, "4.10", "4.0.7", "The stop sign over 55 frames", stop_sign::run),
    experiment(Figure, "4.12", "4.0.8", "Several green signs", green_signs::run),
    experiment(Table, "D.1", "4.0.1", "The tolerances", tolerances::run),
    experiment(Section, "5", "4.0.5", "What corrupts the data most", disturbances::run),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_experiments_share_a_place() {
        for (at, one) in ALL.iter().enumerate() {
            let again =
                ALL[at + 1..].iter().any(|other| (other.place, other.number) == (one.place, one.number));
            assert!(!again, "{} {}", one.place.name(), one.number);
        }
    }
}
