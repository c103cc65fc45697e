//! The pictures of a report: four evenly over the drive, as the thesis's Figure 4.7, and those that went worst.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ingest::recorded::{RecordedItem, RecordedItems};
use recording::RecordingError;
use vision::frame::encode::{Quality, encode_jpeg};
use vision::overlay::{Layers, draw};

use crate::chosen_pictures::ChosenPictures;
use crate::drive::{CameraDrive, Drive};
use crate::figures::{Observation, observations};
use crate::page::Page;
use crate::recorded::RecordedOutcomes;
use crate::score::Claim;
use crate::thumbnail::smaller;
use crate::truth::{TrueObject, meant_object};

const EVENLY: usize = 4;
const WORST: usize = 6;
/// Worst frames lie at least so far apart: neighbours look alike.
const APART_FRAMES: u64 = 6;
const MOST_WIDTH_PX: u32 = 640;
/// What a miss of a landmark that was expected weighs, as if it were off by so much.
const MISS_PX: f64 = 1_000.0;

/// The pictures of all cameras, by camera and number.
pub(super) struct Shots {
    cameras: BTreeMap<Arc<str>, CameraShots>,
}

#[derive(Default)]
struct CameraShots {
    evenly: Vec<u64>,
    /// The worst first, and what is wrong.
    worst: Vec<(u64, String)>,
    /// Base64 of the JPEG.
    pictures: BTreeMap<u64, String>,
}

/// Chooses the frames and reads their pictures.
pub(super) fn take(path: &Path, drive: &Drive) -> Result<Shots, RecordingError> {
    let chosen = drive.cameras.iter().map(|(camera, drive)| (Arc::clone(camera), CameraShots::choose(drive)));
    let mut shots = Shots { cameras: chosen.collect() };
    let (mut outcomes, mut pictures) = (RecordedOutcomes::open(path, None)?, ChosenPictures::default());
    let mut counts: BTreeMap<Arc<str>, u64> = BTreeMap::new();
    for item in RecordedItems::open(path)? {
        let RecordedItem::Picture { camera, picture, .. } = item? else { continue };
        let count = counts.entry(Arc::clone(&camera)).or_default();
        *count += 1;
        let Ok(picture) = picture else { continue };
        let Some(of_camera) = shots.cameras.get_mut(&camera).filter(|shots| shots.wants(*count)) else {
            pictures.pass_over(&camera, &picture);
            continue;
        };
        let decoded = pictures.decode(&camera, &picture, Vec::new());
        let outcome = outcomes.take(&camera, picture.captured_at, picture.sequence)?;
        let (Some(outcome), Ok(mut frame)) = (outcome, decoded) else { continue };
        draw(&mut frame, &outcome, Layers::default());
        if let Ok(jpeg) = encode_jpeg(&smaller(&frame, MOST_WIDTH_PX), Quality::default()) {
            of_camera.pictures.insert(*count, STANDARD.encode(jpeg));
        }
    }
    Ok(shots)
}

impl Shots {
    /// Writes a camera's pictures.
    pub(super) fn write(&self, page: &mut Page, camera: &str) {
        let Some(shots) = self.cameras.get(camera).filter(|shots| !shots.pictures.is_empty()) else { return };
        page.heading(4, "Four frames");
        page.raw("<div class=\"grid four\">");
        for number in &shots.evenly {
            shots.show(page, *number, &format!("Frame {number}"));
        }
        page.raw("</div>");
        if shots.worst.is_empty() {
            return;
        }
        page.heading(4, "Worst frames");
        page.raw("<div class=\"grid\">");
        for (number, why) in &shots.worst {
            shots.show(page, *number, &format!("Frame {number}: {why}"));
        }
        page.raw("</div>");
    }
}

impl CameraShots {
    fn choose(drive: &CameraDrive) -> Self {
        let there: Vec<u64> = drive.registered().filter_map(|(frame, _)| frame.number).collect();
        let at = |part: usize| there.get((2 * part + 1) * there.len() / (2 * EVENLY)).copied();
        let evenly: BTreeSet<u64> = (0..EVENLY).filter_map(at).collect();
        Self { evenly: evenly.into_iter().collect(), worst: worst(drive), pictures: BTreeMap::new() }
    }

    fn wants(&self, number: u64) -> bool {
        self.evenly.contains(&number) || self.worst.iter().any(|(worst, _)| *worst == number)
    }

    fn show(&self, page: &mut Page, number: u64, caption: &str) {
        if let Some(jpeg) = self.pictures.get(&number) {
            page.picture("image/jpeg", jpeg, caption);
        }
    }
}

fn worst(drive: &CameraDrive) -> Vec<(u64, String)> {
    let ids: BTreeSet<&str> = drive
        .registered()
        .flat_map(|(_, outcome)| outcome.landmarks.iter().map(|landmark| landmark.landmark.as_str()))
        .collect();
    let mut faults: Vec<(f64, u64, String)> = ids
        .into_iter()
        .flat_map(|id| observations(drive, id).filter_map(move |seen| fault(id, &seen)))
        .collect();
    faults.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut chosen: Vec<(u64, String)> = Vec::new();
    for (_, number, why) in faults {
        if chosen.len() < WORST && chosen.iter().all(|(other, _)| other.abs_diff(number) >= APART_FRAMES) {
            chosen.push((number, why));
        }
    }
    chosen
}

/// How bad a landmark's result is in a frame, in px or what weighs as much; the frame's number; why.
fn fault(id: &str, seen: &Observation<'_>) -> Option<(f64, u64, String)> {
    let number = seen.frame.number?;
    let claims: Vec<Claim> = Claim::of(seen.best).into_iter().collect();
    let truth = seen.frame.truth.as_ref().map(|truth| meant_object(truth, id, &claims));
    let (weight, why) = match (claims.first(), truth) {
        (Some(claim), Some(truth)) => against_truth(claim, &truth),
        (None, Some(truth)) if truth.visible < 0.5 => return None,
        (None, None) if seen.best.prediction.is_none() => return None,
        (None, _) => {
            let reason = seen.best.result.as_ref().err().map_or("", |miss| miss.name()).replace('_', " ");
            (MISS_PX, format!("missed ({reason})"))
        }
        (Some(_), None) => {
            let innovation_px = f64::from(seen.best.innovation_px?);
            (innovation_px, format!("{innovation_px:.1} px from the prediction"))
        }
    };
    Some((weight, number, format!("{id} {why}")))
}

fn against_truth(claim: &Claim, truth: &TrueObject) -> (f64, String) {
    let off_px = f64::from(claim.centre.distance_px(truth.centre));
    match truth.visible {
        visible if visible < 0.05 => (2.0 * MISS_PX, "claimed, though it does not show".to_owned()),
        _ if off_px > f64::from(truth.tolerance_px) => {
            (MISS_PX + off_px, format!("{off_px:.1} px off: something else"))
        }
        _ => (off_px, format!("{off_px:.1} px off")),
    }
}
