//! `waymark landmark tune`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use analysis::follow_choice::FollowChoice;
use analysis::input::Input;
use analysis::landmark_file::{landmark_text, read_landmark};
use analysis::register::{Job, Timing};
use analysis::truth::Truth;
use analysis::tune::plot::svg;
use analysis::tune::{Change, Example, Judge, Trial, most_trials, tune};
use anyhow::{Context, anyhow};
use vision::ColorStats;

use crate::columns::Columns;
use crate::commands::register::ModeName;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

const EXAMPLES: &str = "\
Examples:
  waymark landmark tune drive --landmark red.json --truth drive/truth.csv -o red-tuned.json
  waymark landmark tune noon.mcap dusk.mcap --landmark red.json --plot tuned.svg

Truth is CSV with the columns frame,object,cx,cy,area,x0,y0,x1,y1,visible (centres counted from the centre of the \
first pixel), where the object is named like the landmark; or a box x,y,w,h on every line, one a frame.";

/// Try windows, tolerances and shades on sequences and recommend the best
///
/// Windows first, then tolerances of the means, then of the variances, then shades: one less, or one more that was seen
/// and is far from the others; each with the best of what was tried before. A false claim weighs five times a
/// detection. Without a truth file, a measurement is taken for right when it lies within one object size of the one
/// before.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Directories or quoted globs of pictures, or recordings; judged together
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,

    /// The landmark file to begin with
    #[arg(long, short, value_name = "FILE")]
    landmark: PathBuf,

    /// Where the object really was; once for each input, in their order
    #[arg(long = "truth", value_name = "FILE")]
    truths: Vec<PathBuf>,

    /// How frames are searched
    #[arg(long, value_enum, default_value_t = ModeName::Adaptive)]
    mode: ModeName,

    /// Write the recommended landmark to this file
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Draw what each trial found against what it claimed falsely, as SVG
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let given = read_landmark(&args.landmark).or_usage()?;
    let examples = args.examples(&given.id)?;
    let job = Job {
        landmarks: None,
        choice: FollowChoice { mode: Some(args.mode.into()), ..FollowChoice::default() },
        threads: NonZeroUsize::MIN,
        timing: Timing::Off,
        overlays: None,
    };
    let bar = console.progress(most_trials(&given) as u64, "trying");
    let mut trials = Vec::new();
    let best = tune(&examples, &given, &job, |trial| {
        bar.inc(1);
        trials.push(trial.clone());
    });
    bar.finish_and_clear();
    let best = best.or_usage()?;
    let report = format!("{}\n{}", table(&trials, &best), reason(&trials[0], &best));
    Console::write_results(report.as_bytes())?;
    if let Some(path) = &args.output {
        let text = landmark_text(&best.landmark).context("cannot write the landmark as JSON")?;
        write(path, &text)?;
    }
    if let Some(path) = &args.plot {
        write(path, &svg(&trials, &best).map_err(anyhow::Error::from)?)?;
    }
    Ok(Ending::Fine)
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("cannot write `{}`", path.display()))
}

impl Args {
    /// Every input with its judge.
    fn examples(&self, object: &str) -> Result<Vec<Example>, Failure> {
        if !self.truths.is_empty() && self.truths.len() != self.inputs.len() {
            let (truths, inputs) = (self.truths.len(), self.inputs.len());
            let said = anyhow!(
                "--truth is given {truths} times for {inputs} inputs; give it once for each, or not at all"
            );
            return Err(Failure::Usage(said));
        }
        let judges = self.truths.iter().map(Some).chain(std::iter::repeat(None));
        let example = |(input, truth): (&String, Option<&PathBuf>)| {
            let judge = match truth {
                Some(path) => Judge::Truth(Truth::read(path, object).or_usage()?),
                None => Judge::Persistence,
            };
            Ok(Example { input: Input::parse(input).or_usage()?, judge })
        };
        self.inputs.iter().zip(judges).map(example).collect()
    }
}

fn table(trials: &[Trial], best: &Trial) -> String {
    let mut table =
        Columns::new(["tried", "window", "± mean", "± variance", "shades", "found %", "false %", ""]);
    for trial in trials {
        let ColorStats { mean, variance } = trial.landmark.tolerance;
        table.row([
            name(trial.change).to_owned(),
            format!("{}×{}", trial.landmark.window_px.width, trial.landmark.window_px.height),
            three(mean),
            three(variance),
            trial.landmark.shades.len().to_string(),
            format!("{:.1}", 100.0 * trial.detection_rate),
            format!("{:.1}", 100.0 * trial.false_rate),
            if trial == best { "best".to_owned() } else { String::new() },
        ]);
    }
    table.text()
}

fn name(change: Change) -> &'static str {
    match change {
        Change::Nothing => "as given",
        Change::Window => "window",
        Change::MeanTolerance => "mean tolerance",
        Change::VarianceTolerance => "variance tolerance",
        Change::Shades => "shades",
    }
}

/// One number where all channels agree, three where they do not.
fn three([red, green, blue]: [f32; 3]) -> String {
    if red == green && green == blue { format!("{red:.1}") } else { format!("{red:.1}/{green:.1}/{blue:.1}") }
}

fn reason(given: &Trial, best: &Trial) -> String {
    if best.landmark == given.landmark {
        return "Keep the landmark as it is: nothing tried found more without more false claims.\n"
            .to_owned();
    }
    let percent = |rate: f64| format!("{:.1} %", 100.0 * rate);
    format!(
        "Use window {}×{} with tolerances {} (means) and {} (variances) and {} shades: found in {} of the frames \
         instead of {}, false claims in {} instead of {}.\n",
        best.landmark.window_px.width,
        best.landmark.window_px.height,
        three(best.landmark.tolerance.mean),
        three(best.landmark.tolerance.variance),
        best.landmark.shades.len(),
        percent(best.detection_rate),
        percent(given.detection_rate),
        percent(best.false_rate),
        percent(given.false_rate),
    )
}
