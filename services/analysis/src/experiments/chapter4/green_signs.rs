//! Section 4.0.8, Figures 4.11 and 4.12: several green signs, one each 200 feet.

use simulator::SceneKind;
use vision::overlay::{Layers, draw};

use crate::chart::{Chart, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::drive::SimulatedDrive;
use crate::experiments::lab::{Followed, GREEN_FRAMES, Manner};
use crate::experiments::{ExperimentError, Lab};

/// The thesis's four frames.
const SHOWN: [usize; 4] = [1, 153, 229, 278];
/// A sign counts when so much of it can be seen, and it is at least so large.
const LEAST_VISIBLE: f64 = 0.5;
const LEAST_AREA_PX2: f64 = 40.0;

/// How many signs there are in view, and how many of them are seen.
#[derive(Clone, Copy, Default)]
struct Count {
    in_view: u32,
    seen: u32,
    wrong: u32,
}

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let drive = lab.drive(SceneKind::GreenSigns)?;
    let mut account = Account::default();
    let mut told = Vec::new();
    for (way, manner) in [("faithful", Manner::Faithful), ("adaptive", Manner::Adaptive)] {
        let followed = lab.followed(SceneKind::GreenSigns, manner)?;
        let counts: Vec<Count> = drive.numbers().map(|number| count(drive, followed, number)).collect();
        let sum = |of: fn(&Count) -> u32| f64::from(counts.iter().map(of).sum::<u32>());
        let (in_view, seen) = (sum(|count| count.in_view), sum(|count| count.seen));
        let found = (in_view > 0.0).then(|| seen / in_view);
        let wrong = sum(|count| count.wrong) / drive.len() as f64;
        account.compare(
            format!("signs found, {way}"),
            Thesis::Words("shown in four frames"),
            found,
            "of signs in view",
            "of 40 px² or more",
        );
        account.compare(format!("false, {way}"), Thesis::Silent, wrong, "a frame", "claims on no sign");
        told.push(format!("{:.0} % {way}", 100.0 * found.unwrap_or(0.0)));
        let points = |of: fn(&Count) -> u32| {
            counts.iter().zip(1..).map(|(count, number)| (f64::from(number), f64::from(of(count)))).collect()
        };
        account.chart(&Chart::over_frames(
            format!("Signs in view and found, {way}"),
            vec![
                Series::new("in view", Mark::Line, points(|count| count.in_view)),
                Series::new("found", Mark::Dots, points(|count| count.seen)),
            ],
        ))?;
    }
    let together = lab.followed(SceneKind::GreenSigns, Manner::Adaptive)?;
    let most = drive.numbers().map(|number| count(drive, together, number).seen).max().unwrap_or(0);
    account.compare(
        "most at once",
        Thesis::Words("multiple"),
        f64::from(most),
        "signs",
        "found in one frame by one landmark, adaptive",
    );
    account.sentence = format!(
        "Of the signs in view over {GREEN_FRAMES} frames {} are found with one landmark, up to {most} at once: a landmark \
         may stand for several objects, each of which is reported.",
        told.join(" and ")
    );
    for number in SHOWN {
        let mut frame = drive.frame(number)?;
        draw(&mut frame, &together.outcomes[number - 1], Layers::OUTLINE | Layers::LABELS);
        account.photograph(&frame, format!("Frame {number} (adaptive)"))?;
    }
    Ok(account)
}

fn count(drive: &SimulatedDrive, followed: &Followed, number: usize) -> Count {
    let claims = followed.claims(number, "sign");
    let mut count = Count::default();
    let mut right = vec![false; claims.len()];
    for object in drive.objects(number) {
        let tolerance_px = (0.5 * object.area_px2.sqrt()).max(3.0);
        let off_px = |centre: vision::PointPx| {
            (f64::from(centre.x) - object.centroid_px[0]).hypot(f64::from(centre.y) - object.centroid_px[1])
        };
        let mut seen = false;
        for (claim, right) in claims.iter().zip(&mut right) {
            if off_px(claim.centre) <= tolerance_px {
                (*right, seen) = (true, true);
            }
        }
        if object.visible >= LEAST_VISIBLE && object.area_px2 >= LEAST_AREA_PX2 {
            count.in_view += 1;
            count.seen += u32::from(seen);
        }
    }
    count.wrong = right.iter().filter(|right| !**right).count() as u32;
    count
}
