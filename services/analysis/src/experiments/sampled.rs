//! A landmark in every so many-th frame of a drive, registered faithfully: for experiments that repeat it under many
//! conditions.

use std::collections::BTreeMap;

use vision::register::{Request, Workspace, register};
use vision::{Frame, Landmark, NoProbe};

use super::ExperimentError;
use super::drive::SimulatedDrive;
use crate::score::{Claim, Score, score};
use crate::truth::Truth;

/// Every so many-th frame is looked at.
pub(super) const STEP: usize = 6;

/// The score over the sampled frames, each `changed` first.
pub(super) fn score_sampled(
    drive: &SimulatedDrive,
    landmark: &Landmark,
    changed: impl Fn(Frame) -> Result<Frame, ExperimentError>,
) -> Result<Score, ExperimentError> {
    let (mut truth, mut all, mut workspace) = (Truth::default(), BTreeMap::new(), Workspace::default());
    for number in drive.numbers().step_by(STEP) {
        let frame = changed(drive.frame(number)?)?;
        let seen =
            register(&frame, landmark, &Request::default(), &mut workspace, &mut NoProbe).unwrap_or_default();
        let claims: Vec<Claim> = seen.first().map(Claim::from).into_iter().collect();
        truth.frames.insert(number as u64, drive.meant(number, &landmark.id, &claims));
        all.insert(number as u64, claims);
    }
    Ok(score(&truth, &all))
}
