//! Section 4.0.7, Figure 4.10: 55 frames of a drive towards a stop sign.

use simulator::SceneKind;
use vision::overlay::{Layers, draw};

use crate::chart::{Axis, Chart, Extent, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::lab::{Manner, STOP_FRAMES};
use crate::experiments::leftmost::Leftmost;
use crate::experiments::{ExperimentError, Lab};
use crate::score::quantile;

/// Frame 11 is the thesis's far one.
const SHOWN: [usize; 4] = [11, 28, 42, 52];
/// Fit from which an outline counts as an octagon.
const OCTAGON_FIT: f64 = 0.5;

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let faithful = lab.score(SceneKind::StopSign, Manner::Faithful, "sign")?;
    let adaptive = lab.score(SceneKind::StopSign, Manner::Adaptive, "sign")?;
    let mut account = Account::default();
    for (way, score) in [("faithful", &faithful), ("adaptive", &adaptive)] {
        account.compare(
            format!("detection, {way}"),
            Thesis::Words("shown in four frames"),
            score.detection_rate,
            "of frames",
            "",
        );
        account.compare(format!("false, {way}"), Thesis::Silent, score.false_rate, "of frames", "");
        account.compare(
            format!("centre error, {way}"),
            Thesis::Silent,
            score.centre_median_px,
            "px",
            "median of right frames",
        );
    }
    let pieces = pieces(lab)?;
    let split = pieces.iter().filter(|&&count| count >= 2.0).count() as f64 / pieces.len().max(1) as f64;
    account.compare(
        "frames in several pieces",
        Thesis::Words("two sections or just blocks of red"),
        split,
        "of frames",
        "pieces of the colour mask in the frame; lettering and clutter make them",
    );
    let fits = fits(lab)?;
    let (far, near) = halves(&fits);
    account.compare(
        "octagon, far half",
        Thesis::Words("no octagon: a red blur"),
        far,
        "fit, 0..1",
        "median fit of the outline, adaptive; 0 where it is too small to tell",
    );
    account.compare(
        "octagon, near half",
        Thesis::Words("recognizable"),
        near,
        "fit, 0..1",
        "the same in the nearer half of the frames",
    );
    let from = fits.iter().find(|(_, _, fit)| *fit >= OCTAGON_FIT).map(|(_, area, _)| *area);
    account.compare(
        "area at the first octagon",
        Thesis::Silent,
        from,
        "px²",
        "true area of the sign when its outline first fits",
    );
    account.sentence = format!(
        "Over {STOP_FRAMES} frames the sign is registered in {} with the thesis's fixed shades and tolerances, in {} when \
         light and scale are followed. {}",
        rate(faithful.detection_rate),
        rate(adaptive.detection_rate),
        from.map_or_else(
            || "Its outline never fits an octagon.".to_owned(),
            |area| format!("Far away it is a blur; from {area:.0} px² on its outline fits an octagon."),
        )
    );
    show(lab, &mut account)?;
    account.chart(&Chart {
        title: "Fit of the outline to an octagon".to_owned(),
        x: Axis::new("true area, px²", Extent::DataFromZero),
        y: Axis::new("fit", Extent::Fixed(0.0, 1.0)),
        series: vec![Series::new(
            "adaptive",
            Mark::Dots,
            fits.iter().map(|&(_, area, fit)| (area, fit)).collect(),
        )],
    })?;
    Ok(account)
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
