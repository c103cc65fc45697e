//! The frames in which methods went worst, with the claims of all drawn in.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use vision::frame::encode::{Quality, encode_jpeg};
use vision::{Frame, PointPx};

use super::race::{Course, decoded};
use super::{CompareError, Race};
use crate::chart::series_colour;
use crate::input::{Input, InputFrame};
use crate::sketch::{line, square};
use crate::thumbnail::smaller;

const WORST: usize = 6;
/// They lie at least so far apart: neighbours look alike.
const APART_FRAMES: u64 = 6;
const MOST_WIDTH_PX: u32 = 640;
/// What a claim that is missing weighs, as if it were off by so much.
const MISS_PX: f64 = 60.0;
const WHITE: [u8; 3] = [255; 3];
const BLACK: [u8; 3] = [0; 3];

/// A frame with all claims.
#[derive(Clone, Debug)]
pub(crate) struct Shot {
    /// JPEG.
    pub(crate) base64: String,
    pub(crate) caption: String,
}

/// Reads the worst frames' pictures.
pub(super) fn take(race: &mut Race, input: &Input) -> Result<(), CompareError> {
    let worst = worst(&race.course);
    let mut decoders = BTreeMap::new();
    for InputFrame { frame: number, camera, picture, .. } in input.open()? {
        // Streams need every picture, so each is decoded.
        let Some((_, mut frame)) = decoded(&mut decoders, &camera, picture.ok()) else { continue };
        let Some(why) = worst.get(&number).filter(|_| camera.as_deref() == race.camera.as_deref()) else {
            continue;
        };
        draw(&mut frame, &race.course, number);
        if let Ok(jpeg) = encode_jpeg(&smaller(&frame, MOST_WIDTH_PX), Quality::default()) {
            let caption = format!("Frame {number}: {why}");
            race.course.shots.push(Shot { base64: STANDARD.encode(jpeg), caption });
        }
    }
    Ok(())
}

/// The frames in which the most methods are furthest off, and which those are.
fn worst(course: &Course) -> BTreeMap<u64, String> {
    let mut faults: Vec<(f64, u64, String)> =
        course.numbers.iter().filter_map(|&number| fault(course, number)).collect();
    faults.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut chosen: BTreeMap<u64, String> = BTreeMap::new();
    for (_, number, why) in faults {
        if chosen.len() < WORST && chosen.keys().all(|other| other.abs_diff(number) >= APART_FRAMES) {
            chosen.insert(number, why);
        }
    }
    chosen
}

/// How far off the methods are together, in which frame, and which ones.
fn fault(course: &Course, number: u64) -> Option<(f64, u64, String)> {
    let (place, tolerance_px) = reference(course, number)?;
    let (mut weight, mut off) = (0.0, Vec::new());
    for lane in &course.lanes {
        let Some(claim) = lane.claims.get(&number) else {
            weight += MISS_PX;
            continue;
        };
        let off_px = f64::from(claim.centre.distance_px(place));
        weight += off_px.min(2.0 * MISS_PX);
        if off_px > f64::from(tolerance_px) {
            off.push(format!("{} {off_px:.0} px", lane.method));
        }
    }
    let missing = course.lanes.iter().filter(|lane| !lane.claims.contains_key(&number)).count();
    let off = if off.is_empty() { "none wrong".to_owned() } else { format!("off: {}", off.join(", ")) };
    Some((weight, number, format!("{off}; {missing} without a claim")))
}

/// Where the object is: by truth, or else in the middle of all claims.
fn reference(course: &Course, number: u64) -> Option<(PointPx, f32)> {
    if let Some(truth) = &course.truth {
        let object = truth.frames.get(&number).filter(|object| object.visible >= 0.5)?;
        return Some((object.centre, object.tolerance_px));
    }
    let middle = |of: fn(PointPx) -> f32| {
        let mut values: Vec<f64> = course
            .lanes
            .iter()
            .filter_map(|lane| Some(f64::from(of(lane.claims.get(&number)?.centre))))
            .collect();
        crate::score::quantile(&mut values, 0.5)
    };
    let centre = PointPx::new(middle(|point| point.x)? as f32, middle(|point| point.y)? as f32);
    Some((centre, 12.0))
}

/// A white cross at the truth, a square in the method's colour at each claim.
fn draw(frame: &mut Frame, course: &Course, number: u64) {
    let truth = course
        .truth
        .as_ref()
        .and_then(|truth| truth.frames.get(&number))
        .filter(|object| object.visible > 0.0);
    if let Some(object) = truth {
        let PointPx { x, y } = object.centre;
        for (width, colour) in [(5, BLACK), (3, WHITE)] {
            line(frame, PointPx::new(x - 14.0, y), PointPx::new(x + 14.0, y), width, colour);
            line(frame, PointPx::new(x, y - 14.0), PointPx::new(x, y + 14.0), width, colour);
        }
    }
    for (at, lane) in course.lanes.iter().enumerate() {
        if let Some(claim) = lane.claims.get(&number) {
            // Each a little larger than the one before, so that those in one place are all seen.
            let side = 12.0 + 5.0 * at as f32;
            square(frame, claim.centre, side + 2.0, 1, BLACK);
            square(frame, claim.centre, side, 2, series_colour(at));
        }
    }
}
