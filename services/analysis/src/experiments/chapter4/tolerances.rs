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

/// A row of Table D.1: where its object is, and the tolerances of means and variances.
struct Row {
    scene: SceneKind,
    landmark: &'static str,
    name: &'static str,
    tolerances: [f64; 2],
}

const TABLE_D_1: [Row; 4] = [
    Row { scene: SceneKind::Rink, landmark: "red", name: "red block", tolerances: [15.0, 50.0] },
    Row { scene: SceneKind::Rink, landmark: "blue", name: "blue block", tolerances: [40.0, 70.0] },
    Row { scene: SceneKind::StopSign, landmark: "sign", name: "stop sign", tolerances: [15.0, 40.0] },
    Row { scene: SceneKind::GreenSigns, landmark: "sign", name: "green sign", tolerances: [40.0, 150.0] },
];

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let mut account = Account::default();
    let (mut found, mut wrong, mut told) = (Vec::new(), Vec::new(), Vec::new());
    for row in &TABLE_D_1 {
        let scores = scores(lab, row)?;
        let best = compare_row(&mut account, row, &scores);
        told.extend(best.map(|best| format!("{best} for the {}", row.name)));
        let rate = |of: fn(&Score) -> Option<f64>| {
            scores.iter().filter_map(|(factor, score)| Some((*factor, 100.0 * of(score)?))).collect()
        };
        found.push(Series::new(row.name, Mark::Line, rate(|score| score.detection_rate)));
        wrong.push(Series::new(row.name, Mark::Line, rate(|score| score.false_rate)));
    }
    account.sentence = format!(
        "On the simulated drives the best factors on Table D.1's tolerances are {}: tolerances go with light, camera and \
         object.",
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

/// The score with each factor.
fn scores(lab: &Lab, row: &Row) -> Result<Vec<(f64, Score)>, ExperimentError> {
    let (drive, landmark) = (lab.drive(row.scene)?, lab.template(row.scene, row.landmark)?);
    let scored =
        |&factor: &f32| Ok((f64::from(factor), score_sampled(drive, &widened(landmark, factor), Ok)?));
    FACTORS.iter().map(scored).collect()
}

/// Puts a row's figures into the account; the factor with the most detections less false ones.
fn compare_row(account: &mut Account, row: &Row, scores: &[(f64, Score)]) -> Option<f64> {
    let merit = |score: &Score| score.detection_rate.unwrap_or(0.0) - score.false_rate.unwrap_or(0.0);
    let best = scores.iter().max_by(|a, b| merit(&a.1).total_cmp(&merit(&b.1))).map(|(factor, _)| *factor);
    let printed = scores.iter().find(|(factor, _)| *factor == 1.0).map(|(_, score)| score);
    let (name, [mean, variance]) = (row.name, row.tolerances);
    let note = format!("tolerances {mean} and {variance} on every {STEP}th simulated frame, faithful");
    let detection = printed.and_then(|score| score.detection_rate);
    account.compare(
        format!("{name} detection"),
        Thesis::Words("tolerances only"),
        detection,
        "of frames",
        note.clone(),
    );
    let wrong = printed.and_then(|score| score.false_rate);
    account.compare(format!("{name} false"), Thesis::Silent, wrong, "of frames", note);
    let note = "most detections less false ones";
    account.compare(format!("{name} best factor"), Thesis::Number(1.0), best, "times Table D.1", note);
    best
}

/// The landmark with both tolerances so many times as wide.
fn widened(landmark: &Landmark, factor: f32) -> Landmark {
    let times = |tolerance: [f32; 3]| tolerance.map(|tolerance| factor * tolerance);
    let ColorStats { mean, variance } = landmark.tolerance;
    Landmark { tolerance: ColorStats { mean: times(mean), variance: times(variance) }, ..landmark.clone() }
}
