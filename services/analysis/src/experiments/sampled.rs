//! A landmark in every so many-th frame of a drive, registered faithfully: for experiments that repeat it under many
//! conditions.

use vision::register::{Request, Workspace, register};
use vision::{Frame, Landmark, NoProbe};

use super::ExperimentError;
use super::drive::SimulatedDrive;
use super::lab::score_numbers;
use crate::score::{Claim, Score};

/// Every so many-th frame is looked at.
pub(super) const STEP: usize = 6;

/// The score over the sampled frames, each `changed` first.
pub(super) fn score_sampled(
    drive: &SimulatedDrive,
    landmark: &Landmark,
    changed: impl Fn(Frame) -> Result<Frame, ExperimentError>,
) -> Result<Score, ExperimentError> {
    let (mut claimed, mut workspace) = (Vec::new(), Workspace::default());
    for number in drive.numbers().step_by(STEP) {
        let frame = changed(drive.frame(number)?)?;
        let seen =
            register(&frame, landmark, &Request::default(), &mut workspace, &mut NoProbe).unwrap_or_default();
        let claims: Vec<Claim> = seen.first().map(Claim::from).into_iter().collect();
        claimed.push((number, claims));
    }
    Ok(score_numbers(drive, &landmark.id, claimed))
}
