//! Table D.1: the tolerances, and what becomes of detection when they are narrower or wider.

use simulator::SceneKind;
use vision::{ColorStats, Landmark};

use crate::chart::{Axis, Chart, Extent, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::sampled::{STEP, score_sampled};
use crate::experiments::{ExperimentError, Lab};
use crate::score::Score;

/// Factors on both tolerances.
const FACTORS: [f32; 7] = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0];

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let rows = [
        (SceneKind::Rink, "red", "red block", [15.0, 50.0]),
        (SceneKind::Rink, "blue", "blue block", [40.0, 70.0]),
        (SceneKind::StopSign, "sign", "stop sign", [15.0, 40.0]),
        (SceneKind::GreenSigns, "sign", "green sign", [40.0, 150.0]),
    ];
    let mut account = Account::default();
    let (mut found, mut wrong, mut told) = (Vec::new(), Vec::new(), Vec::new());
    for (scene, id, name, [mean, variance]) in rows {
        let (drive, landmark) = (lab.drive(scene)?, lab.template(scene, id)?);
        let scores: Vec<(f64, Score)> = FACTORS
            .iter()
            .map(|&factor| Ok((f64::from(factor), score_sampled(drive, &widened(landmark, factor), Ok)?)))
            .collect::<Result<_, ExperimentError>>()?;
        let rate = |of: fn(&Score) -> Option<f64>| {
            scores
                .iter()
                .filter_map(|(factor, score)| Some((*factor, 100.0 * of(score)?)))
                .collect::<Vec<_>>()
        };
        let merit = |score: &Score| score.detection_rate.unwrap_or(0.0) - score.false_rate.unwrap_or(0.0);
        let best =
            scores.iter().max_by(|a, b| merit(&a.1).total_cmp(&merit(&b.1))).map(|(factor, _)| *factor);
        let printed = scores.iter().find(|(factor, _)| *factor == 1.0).map(|(_, score)| score);
        let note = format!("tolerances {mean} and {variance} on every {STEP}th simulated frame, faithful");
        account.compare(
            format!("{name} detection"),
            Thesis::Words("tolerances only"),
            printed.and_then(|score| score.detection_rate),
            "of frames",
            note.clone(),
        );
        account.compare(
            format!("{name} false"),
            Thesis::Silent,
            printed.and_then(|score| score.false_rate),
            "of frames",
            note,
        );
        account.compare(
            format!("{name} best factor"),
            Thesis::Number(1.0),
            best,
            "times Table D.1",
            "most detections less false ones",
        );
        if let Some(best) = best {
            told.push(format!("{best} for the {name}"));
        }
        found.push(Series::new(name, Mark::Line, rate(|score| score.detection_rate)));
        wrong.push(Series::new(name, Mark::Line, rate(|score| score.false_rate)));
    }
    account.sentence = format!(
        "The best factors on Table D.1's tolerances are {}: they are no constants of the method, but follow the light and the \
         camera, and have to be fitted.",
        told.join(", ")
    );
    for (title, series) in [("Detection, %", found), ("False claims, %", wrong)] {
        account.chart(&Chart {
            title: format!("{title}, by the factor on Table D.1's tolerances"),
            x: Axis::new("factor", Extent::Data),
            y: Axis::new("", Extent::Fixed(0.0, 105.0)),
            series,
        })?;
    }
    Ok(account)
}

/// The landmark with both tolerances so many times as wide.
fn widened(landmark: &Landmark, factor: f32) -> Landmark {
    let times = |tolerance: [f32; 3]| tolerance.map(|tolerance| factor * tolerance);
    let ColorStats { mean, variance } = landmark.tolerance;
    Landmark { tolerance: ColorStats { mean: times(mean), variance: times(variance) }, ..landmark.clone() }
}
