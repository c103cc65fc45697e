//! Section 4.0.7, Figure 4.10: 55 frames of a drive towards a stop sign.

use simulator::SceneKind;
use vision::overlay::{Layers, draw};

use crate::chart::{Axis, Chart, Extent, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::lab::{Manner, STOP_FRAMES};
use crate::experiments::leftmost::Leftmost;
use crate::experiments::{ExperimentError, Lab};
use crate::score::{Score, quantile};

/// Frame 11 is the thesis's far one.
const SHOWN: [usize; 4] = [11, 28, 42, 52];
/// Fit from which an outline counts as an octagon.
const OCTAGON_FIT: f64 = 0.5;

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let mut account = Account::default();
    let faithful = detection(lab, Manner::Faithful, "faithful", &mut account)?;
    let adaptive = detection(lab, Manner::Adaptive, "adaptive", &mut account)?;
    let pieces = pieces(lab)?;
    let split = pieces.iter().filter(|&&count| count >= 2.0).count() as f64 / pieces.len().max(1) as f64;
    let note = "pieces of the colour mask in the frame; lettering and clutter make them";
    account.compare(
        "frames in several pieces",
        Thesis::Words("two sections or just blocks of red"),
        split,
        "of frames",
        note,
    );
    let from = octagon(lab, &mut account)?;
    account.sentence = format!(
        "Over {STOP_FRAMES} frames the sign is registered in {} with the thesis's fixed shades and tolerances, in {} when \
         light and scale are followed. {}",
        rate(faithful.detection_rate),
        rate(adaptive.detection_rate),
        from.map_or_else(
            || "Its outline never fits an octagon.".to_owned(),
            |area| format!("Its outline first fits an octagon when its area is {area:.0} px²."),
        )
    );
    show(lab, &mut account)?;
    Ok(account)
}

/// How well the sign is registered.
fn detection(lab: &Lab, manner: Manner, way: &str, account: &mut Account) -> Result<Score, ExperimentError> {
    let score = lab.score(SceneKind::StopSign, manner, "sign")?;
    let said = Thesis::Words("shown in four frames");
    account.compare(format!("detection, {way}"), said, score.detection_rate, "of frames", "");
    account.compare(format!("false, {way}"), Thesis::Silent, score.false_rate, "of frames", "");
    let note = "median of right frames";
    account.compare(format!("centre error, {way}"), Thesis::Silent, score.centre_median_px, "px", note);
    Ok(score)
}

/// How well the outline fits an octagon, far and near; the sign's area when it first does.
fn octagon(lab: &Lab, account: &mut Account) -> Result<Option<f64>, ExperimentError> {
    let fits = fits(lab)?;
    let (far, near) = halves(&fits);
    let blur = Thesis::Words("no octagon: a red blur");
    let note = "median fit of the outline, adaptive; 0 where it is too small to tell";
    account.compare("octagon, far half", blur, far, "fit, 0..1", note);
    let note = "the same in the nearer half of the frames";
    account.compare("octagon, near half", Thesis::Words("recognizable"), near, "fit, 0..1", note);
    let from = fits.iter().find(|(_, _, fit)| *fit >= OCTAGON_FIT).map(|(_, area, _)| *area);
    let note = "true area of the sign when its outline first fits";
    account.compare("area at the first octagon", Thesis::Silent, from, "px²", note);
    let points = fits.iter().map(|&(_, area, fit)| (area, fit)).collect();
    account.chart(&Chart {
        title: "Fit of the outline to an octagon".to_owned(),
        x: Axis::new("true area, px²", Extent::DataFromZero),
        y: Axis::new("fit", Extent::Fixed(0.0, 1.0)),
        series: vec![Series::new("adaptive", Mark::Dots, points)],
    })?;
    Ok(from)
}

fn rate(rate: Option<f64>) -> String {
    rate.map_or_else(|| "none".to_owned(), |rate| format!("{:.0} %", 100.0 * rate))
}

/// Components of the faithful mask in each frame that has any.
fn pieces(lab: &Lab) -> Result<Vec<f64>, ExperimentError> {
    let (drive, landmark) = (lab.drive(SceneKind::StopSign)?, lab.template(SceneKind::StopSign, "sign")?);
    let mut leftmost = Leftmost::default();
    let mut pieces = Vec::new();
    for number in drive.numbers() {
        if leftmost.find(&drive.frame(number)?, landmark).is_some() {
            pieces.push(leftmost.pieces() as f64);
        }
    }
    Ok(pieces)
}

/// Frame, true area and fit of each frame in which the sign is seen.
fn fits(lab: &Lab) -> Result<Vec<(usize, f64, f64)>, ExperimentError> {
    let (drive, followed) =
        (lab.drive(SceneKind::StopSign)?, lab.followed(SceneKind::StopSign, Manner::Adaptive)?);
    let fit = |number: usize| {
        let (seen, object) = (followed.best(number, "sign")?, drive.object(number, "sign").ok()?);
        Some((number, object.area_px2, f64::from(seen.shape_score.unwrap_or(0.0))))
    };
    Ok(drive.numbers().filter_map(fit).collect())
}

/// The median fit of the first and of the second half.
fn halves(fits: &[(usize, f64, f64)]) -> (Option<f64>, Option<f64>) {
    let median = |part: &[(usize, f64, f64)]| {
        quantile(&mut part.iter().map(|(_, _, fit)| *fit).collect::<Vec<_>>(), 0.5)
    };
    let (far, near) = fits.split_at(fits.len() / 2);
    (median(far), median(near))
}

fn show(lab: &Lab, account: &mut Account) -> Result<(), ExperimentError> {
    let (drive, followed) =
        (lab.drive(SceneKind::StopSign)?, lab.followed(SceneKind::StopSign, Manner::Adaptive)?);
    for number in SHOWN {
        let mut frame = drive.frame(number)?;
        draw(&mut frame, &followed.outcomes[number - 1], Layers::OUTLINE | Layers::SEGMENTS | Layers::LABELS);
        account.photograph(&frame, format!("Frame {number} (adaptive)"))?;
    }
    Ok(())
}
