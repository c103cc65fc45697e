//! The list of all experiments, in the order of the thesis.

use super::Place::{Figure, Section, Table};
use super::chapter4::{
    blocks, disturbances, green_signs, prediction, printed_tables, random_segments, search_area, stop_sign,
    synthetic, tolerances,
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
    experiment(Figure, "4.1", "4.0.2", "Random segments and the test of angles", random_segments::run),
    experiment(Table, "4.1", "4.0.4", "The synthetic block's statistics", synthetic::characteristics),
    experiment(Figure, "4.3", "4.0.4", "Registration on the synthetic picture", synthetic::registration),
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
