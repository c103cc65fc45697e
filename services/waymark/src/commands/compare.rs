//! `waymark compare`.

use std::path::{Path, PathBuf};

use analysis::compare::{Method, Question, compare, expected_frames, findings, html};
use analysis::input::Input;
use analysis::landmark_file::read_landmark;
use anyhow::{Context, anyhow};
use vision::Landmark;

use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

const EXAMPLES: &str = "\
Examples:
  waymark compare drive --landmark red.json --truth drive/truth.csv --report compared
  waymark compare drive.mcap --report compared
  waymark compare film.mp4 --landmark red.json --methods adaptive,ncc-colour,optical-flow -o compared

Into the directory go index.html, which needs nothing beside itself, and compare.json: a list with one object for each \
input, camera and landmark.

A recording brings its own landmarks, and one of a simulated camera its own truth. Without truth, methods are judged by \
whether others claim the same place and whether their own claims stay together.

Truth is CSV with the columns frame,object,cx,cy,area,x0,y0,x1,y1,visible (centres counted from the centre of the \
first pixel), where the object is named like the landmark; or a box x,y,w,h on every line, one a frame.

Methods: faithful, adaptive (statistical-gradient), ncc-grey, ncc-colour, ncc-scales (normalised cross correlation), \
phase-correlation, optical-flow (the last place carried along), colour-blob, hough.";

/// Compare methods of registration on your own frames
///
/// All methods see the same frames. The report has detection, false claims, error of centre and area, and processor time
/// of each, plots over time, the frames that went worst, and what follows from the figures.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Directories or quoted globs of pictures (JPEG, PNG), films (FILE.mp4, H.264), or recordings (FILE.mcap; mcap:FILE#TOPIC for one camera)
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,

    /// Landmark file, as `waymark landmark learn` writes it; may be given several times. A recording brings its own
    #[arg(long = "landmark", short, value_name = "FILE")]
    landmarks: Vec<PathBuf>,

    /// Where the object really was
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,

    /// Who takes part [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    methods: Vec<Method>,

    /// The directory that the page and compare.json are written into; made where it is missing
    #[arg(long, short = 'o', visible_alias = "output", value_name = "DIR")]
    report: PathBuf,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let question = args.question()?;
    std::fs::create_dir_all(&args.report)
        .with_context(|| format!("cannot make the directory `{}`", args.report.display()))?;
    let bar = console.progress(expected_frames(&question.inputs), "comparing");
    let races = compare(&question, || bar.inc(1)).or_usage()?;
    bar.finish_and_clear();
    let page = args.report.join("index.html");
    write(&page, html(&races).map_err(anyhow::Error::from)?.as_bytes())?;
    let json = serde_json::to_vec_pretty(&races).context("cannot write the figures as JSON")?;
    write(&args.report.join("compare.json"), &json)?;
    for race in &races {
        console.note(&format!("{} in {}: {}", race.landmark, race.input, findings(race)));
    }
    console.note(&format!("report: {}", page.display()));
    let lost: u64 = races.iter().map(|race| race.lost).max().unwrap_or(0);
    Ok(if lost > 0 { Ending::DataLost } else { Ending::Fine })
}

impl Args {
    fn question(&self) -> Result<Question, Failure> {
        if self.truth.is_some() && self.inputs.len() > 1 {
            let said = anyhow!("--truth is given for {} inputs; compare them one by one", self.inputs.len());
            return Err(Failure::Usage(said));
        }
        let landmarks: Vec<Landmark> =
            self.landmarks.iter().map(|file| read_landmark(file)).collect::<Result<_, _>>().or_usage()?;
        let inputs =
            self.inputs.iter().map(|given| Input::parse(given)).collect::<Result<_, _>>().or_usage()?;
        let methods = if self.methods.is_empty() { Method::ALL.to_vec() } else { self.methods.clone() };
        Ok(Question { inputs, landmarks, truth: self.truth.clone(), methods })
    }
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| format!("cannot write `{}`", path.display()))
}
