//! Section 3.2, Figures 3.4 to 3.7: a frame of the rink.

use simulator::SceneKind;
use vision::methods::ncc::{Colours, NccOptions};
use vision::methods::{Ncc, Plane};
use vision::{Frame, RectPx};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::drive::SimulatedDrive;
use crate::experiments::edges::Lines;
use crate::experiments::lab::{TEMPLATE_FRAME, score_numbers};
use crate::experiments::picture::{grey, heat};
use crate::experiments::{ExperimentError, Lab};
use crate::score::{Claim, Score};
use crate::thumbnail::part;

const BLOCKS: [&str; 4] = ["red", "blue", "black", "tan"];
/// Strongest lines that are taken.
const LINES: usize = 12;
/// A later frame, for a template that is not its own.
const LATER_FRAME: usize = 90;
/// Every so many-th frame is searched.
const STEP: usize = 10;

/// Figures 3.4 and 3.5.
pub(in crate::experiments) fn edges(lab: &Lab) -> Result<Account, ExperimentError> {
    let (frame, boxes) = (lab.rink_frame()?, boxes(lab.drive(SceneKind::Rink)?)?);
    let magnitude = Lines::of(&frame, 1).straight.magnitude;
    let strongest = strongest(&magnitude, 0.02);
    let on_blocks = strongest.iter().filter(|&&(x, y)| boxes.iter().any(|rect| holds(rect, x, y))).count()
        as f64
        / strongest.len().max(1) as f64;
    let area: f64 = boxes.iter().map(|rect| f64::from(rect.width * rect.height)).sum();
    let frame_area = f64::from(frame.width() * frame.height());
    let mut account = Account::default();
    account.compare(
        "strongest edges on blocks",
        Thesis::Words("detected, besides window, rink and floor"),
        on_blocks,
        "of pixels",
        "the strongest 2 % of the gradient; within the blocks' boxes, 3 px wider",
    );
    account.compare("the blocks' boxes", Thesis::Silent, area / frame_area, "of the frame", "");
    account.sentence = format!(
        "Of the strongest two in a hundred edge pixels {:.0} % belong to the four blocks, which cover {:.1} % of the frame; the \
         others are wall, window, floor and pebbles.",
        100.0 * on_blocks,
        100.0 * area / frame_area
    );
    account.photograph(&frame, "Frame 37 of the simulated rink, after Fig 3.4")?;
    account.photograph(&grey(&magnitude, 0.0, 300.0)?, "Sobel's magnitude, after Fig 3.5")?;
    Ok(account)
}

/// Figure 3.6.
pub(in crate::experiments) fn lines(lab: &Lab) -> Result<Account, ExperimentError> {
    let (frame, boxes) = (lab.rink_frame()?, boxes(lab.drive(SceneKind::Rink)?)?);
    let lines = Lines::of(&frame, LINES);
    let share = lines.share_inside(&boxes);
    let mut account = Account::default();
    account.compare(
        "strongest lines on blocks",
        Thesis::Words("lines of the rink and the window"),
        share,
        "of their length",
        format!("the {LINES} strongest lines"),
    );
    account.sentence = format!(
        "{:.1} % of the length of the {LINES} strongest lines lies on a block. Edges and Hough transform say where lines \
         are, not whose.",
        100.0 * share
    );
    account.photograph(&lines.drawn_over(&frame)?, "The strongest lines, after Fig 3.6")?;
    Ok(account)
}

/// Figure 3.7.
pub(in crate::experiments) fn correlation(lab: &Lab) -> Result<Account, ExperimentError> {
    let drive = lab.drive(SceneKind::Rink)?;
    let template = part(&lab.rink_frame()?, drive.region(TEMPLATE_FRAME, "red", 1.0)?);
    let mut account = Account::default();
    let mut told = Vec::new();
    let ways = [
        ("grey", Colours::Grey, vec![1.0]),
        ("colour", Colours::Rgb, vec![1.0]),
        ("colour, 5 sizes", Colours::Rgb, vec![0.7, 0.85, 1.0, 1.3, 1.7]),
    ];
    for (name, colours, scales) in ways {
        let one_size = scales.len() == 1;
        let mut ncc = Ncc::new(&template, &NccOptions { colours, scales })?;
        let found = searched(drive, &mut ncc)?.detection_rate;
        let said = Thesis::Words("has issues with the acquired data");
        let note = format!("the best window of every {STEP}th frame, template of frame 37");
        account.compare(format!("detection over the run, {name}"), said, found, "of frames", note);
        told.push(format!("{:.0} % ({name})", 100.0 * found.unwrap_or(0.0)));
        if one_size {
            surfaces(lab, &mut ncc, name, &mut account)?;
        }
    }
    account.sentence = format!(
        "With the template of frame 37 the best window is the red block in {} of the frames that show it.",
        told.join(", ")
    );
    Ok(account)
}

/// What the coefficients are like in the template's own frame and in a later one.
fn surfaces(lab: &Lab, ncc: &mut Ncc, name: &str, account: &mut Account) -> Result<(), ExperimentError> {
    let drive = lab.drive(SceneKind::Rink)?;
    let later = drive.frame(LATER_FRAME)?;
    let (on_block, elsewhere) = highest(drive, ncc, &later)?;
    let note = "in frame 90, with the template of frame 37";
    let said = Thesis::Words("medium (light blue)");
    account.compare(format!("highest on the block, {name}"), said, on_block, "", note);
    let said = Thesis::Words("strong along rink, pebbles and bricks");
    account.compare(format!("highest elsewhere, {name}"), said, elsewhere, "", note);
    let own = f64::from(ncc.surface(&lab.rink_frame()?, None).maximum().unwrap_or_default().2);
    let note = "1 by definition where the template was cut from the frame";
    account.compare(format!("coefficient at its own place, {name}"), Thesis::Silent, own, "", note);
    let caption = format!("Coefficients in frame 90, {name}: blue is the least, red the greatest");
    account.photograph(&heat(ncc.surface(&later, None))?, caption)
}

/// The score of the best window of every so many-th frame.
fn searched(drive: &SimulatedDrive, ncc: &mut Ncc) -> Result<Score, ExperimentError> {
    let mut claims = Vec::new();
    for number in drive.numbers().step_by(STEP) {
        let found = ncc.search(&drive.frame(number)?, None);
        let claim = found.map(|found| {
            let area_px2 = (found.window.width * found.window.height) as f32;
            Claim { centre: found.at, area_px2, score: found.score }
        });
        claims.push((number, claim.into_iter().collect()));
    }
    Ok(score_numbers(drive, "red", claims))
}

/// The highest coefficient on the block and that of all other windows.
fn highest(drive: &SimulatedDrive, ncc: &mut Ncc, frame: &Frame) -> Result<(f64, f64), ExperimentError> {
    let object = drive.object(LATER_FRAME, "red")?;
    let surface = ncc.surface(frame, None);
    let (columns, rows) = (frame.width() - surface.width() + 1, frame.height() - surface.height() + 1);
    let is_near = |x: u32, y: u32| {
        let (x, y) = (f64::from(x) + f64::from(columns) / 2.0, f64::from(y) + f64::from(rows) / 2.0);
        (x - object.centroid_px[0]).hypot(y - object.centroid_px[1]) <= object.area_px2.sqrt() / 2.0
    };
    let (mut on_block, mut elsewhere) = (-1.0_f32, -1.0_f32);
    for y in 0..surface.height() {
        for x in 0..surface.width() {
            let highest = if is_near(x, y) { &mut on_block } else { &mut elsewhere };
            *highest = highest.max(surface.get(x, y));
        }
    }
    Ok((f64::from(on_block), f64::from(elsewhere)))
}

/// The blocks' bounding boxes, a little wider.
fn boxes(drive: &SimulatedDrive) -> Result<Vec<RectPx>, ExperimentError> {
    let wider = |RectPx { x, y, width, height }: RectPx| RectPx {
        x: x.saturating_sub(3),
        y: y.saturating_sub(3),
        width: width + 6,
        height: height + 6,
    };
    BLOCKS.iter().map(|name| Ok(wider(drive.region(TEMPLATE_FRAME, name, 1.0)?))).collect()
}

fn holds(rect: &RectPx, x: u32, y: u32) -> bool {
    (rect.x..rect.x + rect.width).contains(&x) && (rect.y..rect.y + rect.height).contains(&y)
}

/// The pixels with the largest values, that part of all.
fn strongest(plane: &Plane, part: f64) -> Vec<(u32, u32)> {
    let mut values = plane.values().to_vec();
    values.sort_by(f32::total_cmp);
    let threshold = values[((1.0 - part) * (values.len() - 1) as f64) as usize];
    let places = (0..plane.height()).flat_map(|y| (0..plane.width()).map(move |x| (x, y)));
    places.filter(|&(x, y)| plane.get(x, y) > threshold).collect()
}
