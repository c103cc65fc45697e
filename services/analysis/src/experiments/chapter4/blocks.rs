//! Section 4.0.5: the red and the blue block over 299 frames; Tables 4.2 and 4.3, Figures 4.5 and 4.7.

use simulator::SceneKind;
use vision::overlay::{Layers, draw};

use crate::chart::{Chart, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::drive::SimulatedDrive;
use crate::experiments::lab::{Followed, Manner, RINK_FRAMES, TEMPLATE_FRAME, score_claims, score_numbers};
use crate::experiments::leftmost::Leftmost;
use crate::experiments::{ExperimentError, Lab};
use crate::score::{Claim, Score};
use crate::thumbnail::part;

/// Frames that are shown, evenly over those in which the block is visible.
const SHOWN: usize = 4;
/// A block is visible when so much of it can be seen.
const LEAST_VISIBLE: f64 = 0.5;

/// Tables 4.2 and 4.3: mean and variance of R, G, B.
const RED: [(f64, f64); 3] = [(202.30, 85.08), (71.41, 40.07), (32.90, 58.00)];
const BLUE: [(f64, f64); 3] = [(51.08, 40.28), (59.94, 16.62), (82.26, 38.85)];

/// Table 4.2.
pub(in crate::experiments) fn red_characteristics(lab: &Lab) -> Result<Account, ExperimentError> {
    characteristics(lab, "red", RED)
}

/// Table 4.3.
pub(in crate::experiments) fn blue_characteristics(lab: &Lab) -> Result<Account, ExperimentError> {
    characteristics(lab, "blue", BLUE)
}

fn characteristics(lab: &Lab, id: &str, printed: [(f64, f64); 3]) -> Result<Account, ExperimentError> {
    let landmark = lab.template(SceneKind::Rink, id)?;
    let stats = &landmark.shades[0];
    let mut account = Account::default();
    let mut furthest: f64 = 0.0;
    for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
        let (mean, variance) = printed[channel];
        let (our_mean, our_variance) = (f64::from(stats.mean[channel]), f64::from(stats.variance[channel]));
        let note = "another block, camera and light: only the order of size can agree";
        account.compare(format!("{name} mean"), Thesis::Number(mean), our_mean, "levels", note);
        account.compare(format!("{name} variance"), Thesis::Number(variance), our_variance, "levels²", note);
        furthest = furthest.max((our_mean - mean).abs());
    }
    let window = landmark.window_px;
    account.sentence = format!(
        "The {id} block of the simulated rink, its middle {}×{} pixels in frame {TEMPLATE_FRAME}: its means lie within \
         {furthest:.0} levels of the thesis's block.",
        window.width, window.height
    );
    let region = lab.drive(SceneKind::Rink)?.region(TEMPLATE_FRAME, id, 1.6)?;
    account
        .picture(&part(&lab.rink_frame()?, region), format!("The {id} block in frame {TEMPLATE_FRAME}"))?;
    Ok(account)
}

/// Figure 4.5.
pub(in crate::experiments) fn red(lab: &Lab) -> Result<Account, ExperimentError> {
    block(lab, "red")
}

/// Figure 4.7.
pub(in crate::experiments) fn blue(lab: &Lab) -> Result<Account, ExperimentError> {
    block(lab, "blue")
}

fn block(lab: &Lab, id: &str) -> Result<Account, ExperimentError> {
    let faithful = lab.score(SceneKind::Rink, Manner::Faithful, id)?;
    let adaptive = lab.score(SceneKind::Rink, Manner::Adaptive, id)?;
    let printed = leftmost(lab, id)?;
    let mut account = Account::default();
    let ways = [
        ("as printed, leftmost component", &printed, "what Appendices B and C show that the thesis took"),
        ("faithful, likeliest component", &faithful, "the same mask; the component by size and shape"),
        ("adaptive", &adaptive, "learned by another vehicle; light, noise and scale followed"),
    ];
    for (way, score, note) in ways {
        let thesis = if way.starts_with("as printed") { Thesis::Number(1.0) } else { Thesis::Silent };
        account.compare(format!("{id} detection, {way}"), thesis, score.detection_rate, "of frames", note);
        account.compare(format!("{id} false, {way}"), Thesis::Silent, score.false_rate, "of frames", note);
        account.compare(
            format!("{id} centre error, {way}"),
            Thesis::Silent,
            score.centre_median_px,
            "px",
            "median of right frames",
        );
    }
    for (part, rate) in ["far", "middle", "near"].into_iter().zip(by_thirds(lab, id)?) {
        account.compare(
            format!("{id} detection, {part} third"),
            Thesis::Silent,
            rate,
            "of frames",
            "faithful, with the template of frame 37",
        );
    }
    let growth = growth(lab, id)?;
    account.compare(
        format!("{id} area grows"),
        Thesis::Words("generally increases"),
        growth,
        "of steps",
        "frames 20 apart, adaptive: the later area is the larger one",
    );
    account.sentence = format!(
        "The thesis says that the block was located in all of its {RINK_FRAMES} frames. The simulated cart passes the block \
         earlier: it is visible in {} of them. There, with the thesis's template and tolerances, the leftmost component is \
         the block in {}, the likeliest one in {}; following light and scale, it is found in {}.",
        faithful.frames,
        percent(&printed),
        percent(&faithful),
        percent(&adaptive)
    );
    show(lab, id, &mut account)?;
    Ok(account)
}

fn percent(score: &Score) -> String {
    score.detection_rate.map_or_else(|| "none".to_owned(), |rate| format!("{:.1} %", 100.0 * rate))
}

/// The score of taking the leftmost component of the faithful mask in each frame.
fn leftmost(lab: &Lab, id: &str) -> Result<Score, ExperimentError> {
    let (drive, landmark) = (lab.drive(SceneKind::Rink)?, lab.template(SceneKind::Rink, id)?);
    let mut leftmost = Leftmost::default();
    let claims = drive.numbers().map(|number| Ok(leftmost.find(&drive.frame(number)?, landmark)));
    let claims: Vec<Option<Claim>> = claims.collect::<Result<_, ExperimentError>>()?;
    Ok(score_claims(drive, id, drive.numbers(), |number| claims[number - 1].into_iter().collect()))
}

/// The frames in which a block is visible.
fn visible(drive: &SimulatedDrive, id: &str) -> Vec<usize> {
    let is_visible =
        |number: &usize| drive.object(*number, id).is_ok_and(|object| object.visible >= LEAST_VISIBLE);
    drive.numbers().filter(is_visible).collect()
}

/// Faithful detection in the first, middle and last third of the frames in which the block is visible.
fn by_thirds(lab: &Lab, id: &str) -> Result<[Option<f64>; 3], ExperimentError> {
    let (drive, followed) = (lab.drive(SceneKind::Rink)?, lab.followed(SceneKind::Rink, Manner::Faithful)?);
    let visible = visible(drive, id);
    let mut thirds = visible.chunks(visible.len().div_ceil(3).max(1)).map(|third| {
        let claimed = third.iter().map(|&number| (number, followed.claims(number, id)));
        score_numbers(drive, id, claimed).detection_rate
    });
    Ok(std::array::from_fn(|_| thirds.next().flatten()))
}

/// The part of steps over twenty frames in which the measured area grows.
fn growth(lab: &Lab, id: &str) -> Result<Option<f64>, ExperimentError> {
    let followed = lab.followed(SceneKind::Rink, Manner::Adaptive)?;
    let areas: Vec<f32> = lab
        .drive(SceneKind::Rink)?
        .numbers()
        .step_by(20)
        .filter_map(|number| Some(followed.best(number, id)?.area_px2))
        .collect();
    let steps = areas.len().saturating_sub(1);
    let grown = areas.windows(2).filter(|pair| pair[1] > pair[0]).count();
    Ok((steps > 0).then(|| grown as f64 / steps as f64))
}

fn show(lab: &Lab, id: &str, account: &mut Account) -> Result<(), ExperimentError> {
    let drive = lab.drive(SceneKind::Rink)?;
    let adaptive = lab.followed(SceneKind::Rink, Manner::Adaptive)?;
    let visible = visible(drive, id);
    for number in (0..SHOWN).filter_map(|at| visible.get((2 * at + 1) * visible.len() / (2 * SHOWN)).copied())
    {
        let mut frame = drive.frame(number)?;
        let mut outcome = adaptive.outcomes[number - 1].clone();
        outcome.landmarks.retain(|landmark| landmark.landmark == id);
        draw(&mut frame, &outcome, Layers::OUTLINE | Layers::SEGMENTS | Layers::VECTOR | Layers::LABELS);
        account
            .photograph(&frame, format!("Frame {number}: centre, vector from the origin, area (adaptive)"))?;
    }
    let faithful = lab.followed(SceneKind::Rink, Manner::Faithful)?;
    let courses = |of: &dyn Fn(usize) -> Option<f64>| {
        drive.numbers().filter_map(|number| Some((number as f64, of(number)?))).collect::<Vec<_>>()
    };
    let x = |followed: &Followed| courses(&|number| Some(f64::from(followed.best(number, id)?.centroid.x)));
    let area = |followed: &Followed| courses(&|number| Some(f64::from(followed.best(number, id)?.area_px2)));
    let truth = |value: fn(&simulator::TrueObject) -> f64| {
        courses(&|number| drive.object(number, id).ok().map(value))
    };
    account.chart(&Chart::over_frames(
        format!("X of the {id} block, px"),
        vec![
            Series::new("faithful", Mark::Dots, x(faithful)),
            Series::new("adaptive", Mark::Dots, x(adaptive)),
            Series::new("truth", Mark::Line, truth(|object| object.centroid_px[0])),
        ],
    ))?;
    account.chart(&Chart::over_frames(
        format!("Area of the {id} block, px²"),
        vec![
            Series::new("faithful", Mark::Dots, area(faithful)),
            Series::new("adaptive", Mark::Dots, area(adaptive)),
            Series::new("truth", Mark::Line, truth(|object| object.area_px2)),
        ],
    ))?;
    Ok(())
}
