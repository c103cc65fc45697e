//! `waymark register`.

mod differences;
mod names;
mod per_input;
mod results;
mod tally;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;

use analysis::follow_choice::FollowChoice;
use analysis::input::{Frames, Input, InputError};
use analysis::landmark_file::read_landmark_set;
use analysis::overlays::Overlays;
use analysis::register::{Event, Job, Timing, register};
use analysis::stage_times::StageTimes;
use anyhow::{Context, anyhow};
use vision::register::ShapeVeto;

use super::batch::with_recordings;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

pub(super) use names::ModeName;
use names::{FormatName, PredictionName};
use per_input::PerInput;
use results::{Results, Seen};
use tally::Tally;

const EXAMPLES: &str = "\
Examples:
  waymark register drive --landmark red.json --landmark blue.json > drive.csv
  waymark register 'left/*.jpg' --landmark stop.json --mode faithful --require-shape --stats cost.json
  waymark register recordings/*.mcap --format ndjson > all.ndjson
  waymark register 'recordings/*.mcap' --into tables
  waymark register drive.mcap --diff
  waymark register drive.mcap --landmark better.json --diff -o drive-again.mcap

Columns: input, frame (from 1 within its input and camera), captured_at_ns (Unix epoch; nominal for plain pictures, 30 a \
second from 0), camera, landmark, instance, result (measured, or why not), x_px, y_px, area_px2, mask_area_2x, \
shape_score, score, predicted_x_px, predicted_y_px, predicted_area_px2, innovation_px, gain, bearing_rad, range_m. \
Unknown is empty.

A picture that cannot be read or decoded is named on stderr, has no rows, and makes the exit code 3.

With --diff the table has one row for each field that is not as it was recorded live: input, frame, captured_at_ns, \
camera, landmark, instance, field, recorded, again, difference (a distance where the field is a place), past. The exit \
code is 0 when nothing differs and 1 when something does. Frames that were registered live after a picture which is not \
in the file have past `missing`: they are listed and counted, but not judged.";

/// Register landmarks in pictures, films and recordings
///
/// Each input is a sequence, followed from its first frame to its last: a directory or a (quoted) glob of pictures in
/// natural order, a film, or the cameras of a recording. The result is a table with one row for each frame, landmark and
/// instance.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Directories or quoted globs of pictures (JPEG, PNG), films (FILE.mp4, H.264), or recordings (FILE.mcap or quoted globs of them; mcap:FILE#TOPIC for one camera)
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,

    /// Landmark file, as `waymark landmark learn` writes it; may be given several times. A recording brings its own
    /// landmarks: without this option, they are looked for in the frames in which they were looked for live
    #[arg(long = "landmark", short, value_name = "FILE")]
    landmarks: Vec<PathBuf>,

    /// How frames are searched [default: as a recording was live, else adaptive]
    #[arg(long, value_enum)]
    mode: Option<ModeName>,

    /// How the place in the next frame is predicted [default: as a recording was live, else kalman]
    #[arg(long, value_enum)]
    prediction: Option<PredictionName>,

    /// Do not report objects that are large enough to show their shape and show another
    #[arg(long)]
    require_shape: bool,

    /// How the table is written
    #[arg(long, value_enum, default_value_t = FormatName::Csv)]
    format: FormatName,

    /// Write a table for each input into this directory instead; one that is newer than its recording is kept, so that
    /// an interrupted run goes on where it was when it is repeated
    #[arg(long, value_name = "DIR", conflicts_with_all = ["diff", "output"])]
    into: Option<PathBuf>,

    /// Compare with what the recordings say was registered live, and write what differs instead of the table
    #[arg(long)]
    diff: bool,

    /// Write the recording again, every message untouched, with the new results beside the old ones on
    /// `…/registration/again` and `…/annotations/again`; must not exist yet
    #[arg(long, short, value_name = "FILE.mcap")]
    output: Option<PathBuf>,

    /// Write every frame with the result drawn in: as a JPEG into this directory, or as a film (H.264)
    #[arg(long, value_name = "DIR|FILE.mp4")]
    overlays: Option<PathBuf>,

    /// Write what each stage costs, in milliseconds of thread CPU time, as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,

    /// Inputs worked on at the same time [default: one for each processor]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let job = args.job()?;
    let given = with_recordings(&args.inputs)?;
    let tables = args.into.as_ref().map(|into| PerInput::begin(into, &given, args.format)).transpose()?;
    let is_due = |given: &&String| tables.as_ref().is_none_or(|tables| tables.is_due(given));
    let due: Vec<String> = given.iter().filter(is_due).cloned().collect();
    if due.len() < given.len() {
        console.note(&format!("{} tables were there already", given.len() - due.len()));
    }
    let inputs = open_inputs(&due)?;
    if let Some((input, _)) =
        inputs.iter().find(|(_, frames)| job.landmarks.is_none() && !frames.brings_landmarks())
    {
        return Err(Failure::Usage(anyhow!(
            "`{}` brings no landmarks of its own; say what to look for with --landmark FILE",
            input.given
        )));
    }
    if inputs.len() > 1 && inputs.iter().all(|(_, frames)| frames.size_hint().0 == 1) {
        console.note(
            "note: every input is one picture; quote a glob to have its pictures followed as one sequence",
        );
    }
    let frames = inputs.iter().map(|(_, frames)| frames.size_hint().0 as u64).sum();
    let mut tally = Tally::default();
    let mut results = Results::begin(args, tables, &inputs, job.landmarks.clone())?;
    let bar = console.progress(frames, "registering");
    let times = register(inputs, &job, |input, event| -> anyhow::Result<()> {
        bar.inc(1);
        match event {
            Event::Lost(lost) => bar.suspend(|| tally.lose(console, &lost)),
            Event::NotDrawn(error) => return Err(error.into()),
            Event::Registered { frame, camera, outcome, places, recorded } => {
                tally.count(&outcome);
                let (camera, places) = (camera.as_ref(), places.as_slice());
                results.take(&Seen { input, frame, camera, outcome: &outcome, places, recorded })?;
            }
        }
        Ok(())
    })?;
    bar.finish_and_clear();
    args.write_stats(&times)?;
    let compared = results.finish(args, console)?;
    Ok(match (compared, tally.ending(console)) {
        (Ending::Different, _) => Ending::Different,
        (_, ending) => ending,
    })
}

fn open_inputs(given: &[String]) -> Result<Vec<(Input, Frames)>, Failure> {
    let open = |given: &String| {
        let input = Input::parse(given)?;
        let frames = input.open()?;
        Ok((input, frames))
    };
    given.iter().map(open).collect::<Result<_, InputError>>().or_usage()
}

impl Args {
    fn job(&self) -> Result<Job, Failure> {
        Ok(Job {
            landmarks: match self.landmarks.as_slice() {
                [] => None,
                files => Some(Arc::new(read_landmark_set(files).or_usage()?)),
            },
            choice: FollowChoice {
                mode: self.mode.map(Into::into),
                prediction: self.prediction.map(Into::into),
                shape_veto: self.require_shape.then_some(ShapeVeto::Required),
            },
            threads: self
                .threads
                .or_else(|| std::thread::available_parallelism().ok())
                .unwrap_or(NonZeroUsize::MIN),
            overlays: self.overlays.clone().map(Overlays::to).transpose().or_usage()?,
            timing: if self.stats.is_some() { Timing::On } else { Timing::Off },
        })
    }

    fn write_stats(&self, times: &StageTimes) -> anyhow::Result<()> {
        let Some(path) = &self.stats else { return Ok(()) };
        let text = format!("{:#}\n", times.summary());
        std::fs::write(path, text).with_context(|| format!("cannot write `{}`", path.display()))
    }
}
