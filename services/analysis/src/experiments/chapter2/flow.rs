//! Figure 2.9: optical flow of two blocks that move; and section 2.8's method on a moving camera (chapter 5).

use simulator::SceneKind;
use vision::methods::{Flow, HornSchunck, Intensity, Plane};
use vision::{RectPx, SizePx};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::lab::TEMPLATE_FRAME;
use crate::experiments::picture::{arrows, grey};
use crate::experiments::{ExperimentError, Lab};

const SIZE: SizePx = SizePx { width: 160, height: 120 };
const SIDE: f32 = 28.0;
/// Flow above this is motion.
const MOVES_PX: f32 = 0.1;

/// Figure 2.9.
pub(in crate::experiments) fn blocks(_: &Lab) -> Result<Account, ExperimentError> {
    let upper = ((104.0, 16.0), (1.0, 1.0));
    let lower = ((106.0, 78.0), (-1.0, 0.0));
    let picture = |time: f32| {
        let places = [upper, lower].map(|((x, y), (dx, dy))| (x + time * dx, y + time * dy));
        Plane::from_fn(SIZE, |x, y| places.iter().map(|&place| soft_block(place, x, y)).fold(30.0, f32::max))
    };
    let (first, second) = (picture(0.0), picture(1.0));
    let flow = HornSchunck::default().flow(&first, &second)?;
    let mut account = Account::default();
    let mut told = Vec::new();
    let blocks =
        [("upper block", upper, "diagonally down to the right"), ("lower block", lower, "right to left")];
    for (name, ((x, y), (dx, dy)), said) in blocks {
        let around = RectPx { x: x as u32, y: y as u32, width: SIDE as u32, height: SIDE as u32 };
        let (u, v) = flow.mean_px(around).unwrap_or_default();
        let off = angle_between((u, v), (dx, dy));
        account.compare(
            format!("{name}, direction error"),
            Thesis::Words(said),
            off,
            "degrees",
            "of the mean flow over the block",
        );
        account.compare(
            format!("{name}, speed"),
            Thesis::Silent,
            f64::from(u.hypot(v) / dx.hypot(dy)),
            "of the true one",
            "",
        );
        told.push(format!("{off:.0}° ({name})"));
    }
    account.sentence =
        format!("The mean flow over the blocks is off by {} in its direction.", told.join(" and "));
    account.picture(&grey(&first, 0.0, 255.0)?, "First picture, after Fig 2.9")?;
    account.picture(&grey(&second, 0.0, 255.0)?, "Second picture")?;
    account.picture(&arrows(&first, &flow, 6, 5.0)?, "Flow, five times as long as it is")?;
    Ok(account)
}

/// Chapter 5: flow while the camera itself moves.
pub(in crate::experiments) fn moving_camera(lab: &Lab) -> Result<Account, ExperimentError> {
    let drive = lab.drive(SceneKind::Rink)?;
    let number = 3 * TEMPLATE_FRAME;
    let plane =
        |number: usize| Ok::<Plane, ExperimentError>(Plane::of(&drive.frame(number)?, Intensity::Luma));
    let (first, second) = (plane(number)?, plane(number + 2)?);
    let flow = HornSchunck::default().flow(&first, &second)?;
    let moving = flow.u.values().iter().zip(flow.v.values()).filter(|(u, v)| u.hypot(**v) > MOVES_PX).count();
    let share = moving as f64 / flow.u.values().len() as f64;
    let mut account = Account::default();
    account.compare(
        "pixels that move",
        Thesis::Words("all objects and the background"),
        share,
        "of the frame",
        "flow above .1 px between frames 111 and 113 of the rink",
    );
    let mut apart = Vec::new();
    for id in ["red", "blue"] {
        let object = drive.region(number, id, 1.0)?;
        let around = drive.region(number, id, 3.0)?;
        let contrast = contrast(&flow, object, around);
        account.compare(
            format!("{id} block against its surroundings"),
            Thesis::Words("difficult"),
            contrast,
            "px",
            "difference of the mean flows",
        );
        apart.extend(contrast);
    }
    let most = apart.iter().copied().fold(0.0, f64::max);
    account.sentence = format!(
        "With the camera in motion {:.0} % of the pixels move, and a block's mean flow differs from its surroundings' by at \
         most {most:.2} px.",
        100.0 * share
    );
    let shown = drive.region(number, "red", 8.0)?;
    let part = Flow { u: flow.u.cropped(shown), v: flow.v.cropped(shown) };
    let caption = "Flow around the red block in frame 111, four times as long as it is";
    account.picture(&arrows(&first.cropped(shown), &part, 10, 4.0)?, caption)?;
    Ok(account)
}

fn contrast(flow: &Flow, object: RectPx, around: RectPx) -> Option<f64> {
    let ((u, v), (around_u, around_v)) = (flow.mean_px(object)?, flow.mean_px(around)?);
    Some(f64::from((u - around_u).hypot(v - around_v)))
}

/// A block with soft edges and a brightness that varies over it.
fn soft_block((left, top): (f32, f32), x: u32, y: u32) -> f32 {
    let inside = |at: f32| (at / 4.0).clamp(0.0, 1.0) * ((SIDE - at) / 4.0).clamp(0.0, 1.0);
    let (dx, dy) = (x as f32 - left, y as f32 - top);
    let shade = 150.0 + 25.0 * (dx / 5.0).sin() + 25.0 * (dy / 6.0).cos();
    30.0 + inside(dx) * inside(dy) * shade
}

fn angle_between((u, v): (f32, f32), (dx, dy): (f32, f32)) -> f64 {
    let apart = f64::from(v).atan2(f64::from(u)) - f64::from(dy).atan2(f64::from(dx));
    let apart = apart.to_degrees().rem_euclid(360.0);
    apart.min(360.0 - apart)
}
