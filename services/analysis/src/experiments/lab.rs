//! What experiments share: the simulated drives, the landmarks, and what was registered, each made when first asked for.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

use simulator::{SceneKind, SceneOptions};
use vision::follow::{Follow, FollowOptions, FrameStamp, Mode};
use vision::learn::{LearnOptions, Preset, Template, Tolerance, learn};
use vision::{Frame, Landmark, LandmarkSet, NoProbe, Outcome, RectPx, SetVersion, ShapeClass};
use waymark_proto::digest::landmark_digest;

use super::ExperimentError;
use super::drive::SimulatedDrive;
use crate::lesson::{FOLLOWER, learn_from};
use crate::score::{Claim, Score, score};
use crate::truth::Truth;

/// Chooses the worlds.
const SEED: u64 = 1;
/// Frames of the thesis's run on the rink (3.2).
pub(super) const RINK_FRAMES: u64 = 299;
/// Its frame in Figures 3.4 to 3.7, from which the templates were taken.
pub(super) const TEMPLATE_FRAME: usize = 37;
/// Frames of its drive towards a stop sign (4.0.7).
pub(super) const STOP_FRAMES: u64 = 55;
/// Frames of the drive past green signs, of which it shows four, the last one number 278 (4.0.8).
pub(super) const GREEN_FRAMES: u64 = 300;
/// A webcam of its time.
const STOP_RATE_HZ: f64 = 15.0;
/// Part of a block's box that is surely block.
const TEMPLATE_PART: f64 = 0.5;

/// How a drive is registered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Manner {
    /// The thesis's way: the template from the drive itself with Table D.1's tolerances, statistics fixed, no gate.
    Faithful,
    /// What is usual here: learned by a leader on its own drive, and followed.
    Adaptive,
}

/// What was seen on a drive.
pub(super) struct Followed {
    /// One for each frame.
    pub(super) outcomes: Vec<Outcome>,
}

#[derive(Default)]
struct OfScene {
    drive: OnceCell<SimulatedDrive>,
    templates: OnceCell<Vec<Landmark>>,
    faithful: OnceCell<Followed>,
    adaptive: OnceCell<Followed>,
}

/// Everything that more than one experiment uses.
#[derive(Default)]
pub struct Lab {
    scenes: [OfScene; 3],
}

impl Lab {
    fn of(&self, scene: SceneKind) -> &OfScene {
        &self.scenes[scene as usize]
    }

    /// The drive of a scene.
    pub(super) fn drive(&self, scene: SceneKind) -> Result<&SimulatedDrive, ExperimentError> {
        once(&self.of(scene).drive, || {
            let options = SceneOptions { seed: SEED, vehicle: FOLLOWER, ..SceneOptions::new(scene) };
            match scene {
                SceneKind::Rink => SimulatedDrive::of(
                    SceneOptions { frames_one_way: RINK_FRAMES as u32, ..options },
                    RINK_FRAMES,
                ),
                SceneKind::StopSign => SimulatedDrive::of(
                    SceneOptions {
                        frames_one_way: STOP_FRAMES as u32,
                        frame_rate_hz: STOP_RATE_HZ,
                        ..options
                    },
                    STOP_FRAMES,
                ),
                SceneKind::GreenSigns => SimulatedDrive::of(options, GREEN_FRAMES),
            }
        })
    }

    /// The frame of Figure 3.4.
    pub(super) fn rink_frame(&self) -> Result<Frame, ExperimentError> {
        self.drive(SceneKind::Rink)?.frame(TEMPLATE_FRAME)
    }

    /// The landmarks of a scene as the thesis took them: from the drive itself, with Table D.1's tolerances.
    pub(super) fn templates(&self, scene: SceneKind) -> Result<&[Landmark], ExperimentError> {
        let templates = once(&self.of(scene).templates, || {
            let drive = self.drive(scene)?;
            match scene {
                SceneKind::Rink => [("red", Preset::RedBlock), ("blue", Preset::BlueBlock)]
                    .into_iter()
                    .map(|(id, preset)| block(drive, id, preset))
                    .collect(),
                SceneKind::StopSign => {
                    Ok(vec![sign(drive, &[30, 52], "sign", ShapeClass::Octagon, Preset::StopSign)?])
                }
                SceneKind::GreenSigns => {
                    Ok(vec![sign(drive, &[40], "sign-1", ShapeClass::Rectangle, Preset::GreenSign)?])
                }
            }
        })?;
        Ok(templates)
    }

    /// One of them.
    pub(super) fn template(&self, scene: SceneKind, id: &str) -> Result<&Landmark, ExperimentError> {
        let found = self.templates(scene)?.iter().find(|landmark| landmark.id == id);
        found.ok_or_else(|| ExperimentError::NotShown {
            scene: scene.to_string(),
            frame: TEMPLATE_FRAME,
            object: id.to_owned(),
        })
    }

    /// What is seen on a scene's drive.
    pub(super) fn followed(&self, scene: SceneKind, manner: Manner) -> Result<&Followed, ExperimentError> {
        let cell = match manner {
            Manner::Faithful => &self.of(scene).faithful,
            Manner::Adaptive => &self.of(scene).adaptive,
        };
        once(cell, || {
            let (landmarks, mode) = match manner {
                Manner::Faithful => (self.templates(scene)?.to_vec(), Mode::Faithful),
                Manner::Adaptive => (learn_from(scene, SEED)?, Mode::Adaptive),
            };
            follow(self.drive(scene)?, landmarks, mode)
        })
    }

    /// How well a landmark was registered.
    pub(super) fn score(&self, scene: SceneKind, manner: Manner, id: &str) -> Result<Score, ExperimentError> {
        let (drive, followed) = (self.drive(scene)?, self.followed(scene, manner)?);
        Ok(score_claims(drive, id, drive.numbers(), |number| followed.claims(number, id)))
    }
}

impl Followed {
    /// What was claimed of a landmark in a frame.
    pub(super) fn claims(&self, number: usize, id: &str) -> Vec<Claim> {
        let of_landmark =
            self.outcomes[number - 1].landmarks.iter().filter(|landmark| landmark.landmark == id);
        of_landmark.filter_map(Claim::of).collect()
    }

    /// The best sighting of a landmark in a frame.
    pub(super) fn best(&self, number: usize, id: &str) -> Option<&vision::Sighting> {
        let of_landmark =
            self.outcomes[number - 1].landmarks.iter().filter(|landmark| landmark.landmark == id);
        let seen = of_landmark.filter_map(|landmark| landmark.result.as_ref().ok());
        seen.reduce(|best, seen| if seen.score > best.score { seen } else { best })
    }
}

/// Scores the claims of these frames.
pub(super) fn score_claims(
    drive: &SimulatedDrive,
    id: &str,
    numbers: RangeInclusive<usize>,
    claims: impl Fn(usize) -> Vec<Claim>,
) -> Score {
    score_numbers(drive, id, numbers.map(|number| (number, claims(number))))
}

/// Scores the claims of some frames, each with its number.
pub(super) fn score_numbers(
    drive: &SimulatedDrive,
    id: &str,
    claimed: impl IntoIterator<Item = (usize, Vec<Claim>)>,
) -> Score {
    let (mut truth, mut all) = (Truth::default(), BTreeMap::new());
    for (number, claims) in claimed {
        truth.frames.insert(number as u64, drive.meant(number, id, &claims));
        all.insert(number as u64, claims);
    }
    score(&truth, &all)
}

/// Follows landmarks over a drive.
pub(super) fn follow(
    drive: &SimulatedDrive,
    landmarks: Vec<Landmark>,
    mode: Mode,
) -> Result<Followed, ExperimentError> {
    let mut landmarks: Vec<Arc<Landmark>> = landmarks.into_iter().map(Arc::new).collect();
    landmarks.sort_by(|a, b| a.id.cmp(&b.id));
    let set = LandmarkSet { version: SetVersion::default(), landmarks };
    let mut follow = Follow::new(FollowOptions { mode, ..FollowOptions::default() }, set);
    let outcomes = drive.numbers().map(|number| {
        let stamp = FrameStamp { sequence: number as u64, captured_at: drive.captured_at(number) };
        Ok(follow.on_frame(&drive.frame(number)?, stamp, &mut NoProbe))
    });
    Ok(Followed { outcomes: outcomes.collect::<Result<_, ExperimentError>>()? })
}

/// A block's template: the middle of it, all pixels (4.0.1).
fn block(drive: &SimulatedDrive, id: &str, preset: Preset) -> Result<Landmark, ExperimentError> {
    let region = drive.region(TEMPLATE_FRAME, id, TEMPLATE_PART)?;
    let options = LearnOptions {
        id: id.to_owned(),
        shape: ShapeClass::Block,
        tolerance: Tolerance::Preset(preset),
        template: Template::Exact,
        ..LearnOptions::default()
    };
    digested(learn(&[(&drive.frame(TEMPLATE_FRAME)?, region)], &options)?)
}

/// A sign's template, a shade for each frame. Its lettering is told apart: the thesis does not say what it did with it.
fn sign(
    drive: &SimulatedDrive,
    numbers: &[usize],
    object: &str,
    shape: ShapeClass,
    preset: Preset,
) -> Result<Landmark, ExperimentError> {
    let views = numbers.iter().map(|&number| Ok((drive.frame(number)?, drive.region(number, object, 1.0)?)));
    let views: Vec<(Frame, RectPx)> = views.collect::<Result<_, ExperimentError>>()?;
    let views: Vec<(&Frame, RectPx)> = views.iter().map(|(frame, region)| (frame, *region)).collect();
    let options = LearnOptions {
        id: "sign".to_owned(),
        shape,
        tolerance: Tolerance::Preset(preset),
        ..LearnOptions::default()
    };
    digested(learn(&views, &options)?)
}

fn digested(landmark: Landmark) -> Result<Landmark, ExperimentError> {
    Ok(Landmark { digest: landmark_digest(&landmark), ..landmark })
}

/// What the cell holds, made first where it is empty.
fn once<T>(
    cell: &OnceCell<T>,
    make: impl FnOnce() -> Result<T, ExperimentError>,
) -> Result<&T, ExperimentError> {
    if let Some(made) = cell.get() {
        return Ok(made);
    }
    let made = make()?;
    Ok(cell.get_or_init(|| made))
}
