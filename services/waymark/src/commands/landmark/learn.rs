//! `waymark landmark learn`.

use std::path::PathBuf;
use std::str::FromStr;

use analysis::landmark_file::landmark_text;
use analysis::learn::learn_from_files;
use analysis::region::PictureRegion;
use anyhow::Context;
use clap::ValueEnum;
use vision::learn::{LearnOptions, Preset, Template, Tolerance};
use vision::{ColorStats, Landmark, ShapeClass, WindowPx};

use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

const EXAMPLES: &str = "\
Examples:
  waymark landmark learn f037.jpg#xywh=446,314,25,24 --id red --shape block -o red.json
  waymark landmark learn near.jpg#xywh=210,88,61,60 far.jpg#xywh=305,140,14,14 --id stop --shape octagon --size-m 0.75
  waymark landmark learn 'drive.mp4#t=0.5&xywh=640,180,70,60' --id yellow -o yellow.json

The shell may treat # as a comment only at the beginning of a word, so regions need no quotes; & needs them.";

/// Learn a landmark from one or several pictures of it
///
/// Each region is the object's bounding box in its picture; background in the corners and lettering are told apart
/// from the object. Several regions become several shades of one landmark. The result is a landmark file (JSON).
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Picture and region: FILE#xywh=X,Y,W,H in pixels from the top-left corner, or #xywh=percent:X,Y,W,H; a picture
    /// without a region is the object from edge to edge. FILE.mp4#t=SECONDS&xywh=X,Y,W,H takes the frame of a film
    #[arg(required = true, value_name = "IMAGE#xywh=X,Y,W,H")]
    regions: Vec<PictureRegion>,

    /// Name of the landmark: lower-case letters, digits, `-` and `_`, at most 63
    #[arg(long)]
    id: String,

    /// Outline that the object shows when it is large enough
    #[arg(long, value_enum, default_value_t = Shape::Any)]
    shape: Shape,

    /// Physical width of the object in metres, so that its range can be told
    #[arg(long, value_name = "METRES")]
    size_m: Option<f32>,

    /// Averaging window in samples of the doubled grid, each 1..512 [default: the largest even square up to 12 that
    /// fits the object]
    #[arg(long, value_name = "W,H")]
    window: Option<Pair<u16>>,

    /// How far means (levels) and variances (levels²) may be off [default: fitted to the region, at least 15,50]
    #[arg(long, value_name = "MEAN,VARIANCE", conflicts_with = "preset")]
    tolerance: Option<Pair<f32>>,

    /// Tolerances of a row of the reference thesis's Table D.1
    #[arg(long, value_enum)]
    preset: Option<PresetName>,

    /// Take the region itself as the template, all its pixels, its size as the window
    #[arg(long)]
    exact: bool,

    /// Where the landmark file goes [default: stdout]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// `A,B` on the command line.
#[derive(Clone, Copy, Debug)]
struct Pair<T>(T, T);

impl<T: FromStr> FromStr for Pair<T> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once(',').map(|(a, b)| (a.trim().parse(), b.trim().parse()));
        match numbers {
            Some((Ok(a), Ok(b))) => Ok(Self(a, b)),
            _ => Err("two numbers with a comma between them are needed, for example 12,12".to_owned()),
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Shape {
    /// No statement
    Any,
    /// Perpendicular pairs of edges
    Block,
    /// Two parallel pairs of edges: road signs
    Rectangle,
    /// Eight edges
    Octagon,
    /// Three edges
    Triangle,
    /// A circle, mildly foreshortened at most
    Circle,
}

impl From<Shape> for ShapeClass {
    fn from(shape: Shape) -> Self {
        match shape {
            Shape::Any => Self::Any,
            Shape::Block => Self::Block,
            Shape::Rectangle => Self::Rectangle,
            Shape::Octagon => Self::Octagon,
            Shape::Triangle => Self::Triangle,
            Shape::Circle => Self::Circle,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PresetName {
    /// Mean 15, variance 50
    RedBlock,
    /// Mean 40, variance 70
    BlueBlock,
    /// Mean 15, variance 40
    StopSign,
    /// Mean 40, variance 150
    GreenSign,
}

impl From<PresetName> for Preset {
    fn from(name: PresetName) -> Self {
        match name {
            PresetName::RedBlock => Self::RedBlock,
            PresetName::BlueBlock => Self::BlueBlock,
            PresetName::StopSign => Self::StopSign,
            PresetName::GreenSign => Self::GreenSign,
        }
    }
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let landmark = learn_from_files(&args.regions, &args.options()).or_usage()?;
    let text = landmark_text(&landmark).context("cannot write the landmark as JSON")?;
    match &args.output {
        None => Console::write_results(text.as_bytes())?,
        Some(path) => {
            std::fs::write(path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
            console.note(&format!("{}: {}", path.display(), in_one_line(&landmark)));
        }
    }
    Ok(Ending::Fine)
}

impl Args {
    fn options(&self) -> LearnOptions {
        LearnOptions {
            id: self.id.clone(),
            shape: self.shape.into(),
            size_m: self.size_m,
            window_px: self.window.map(|Pair(width, height)| WindowPx { width, height }),
            tolerance: match (self.tolerance, self.preset) {
                (Some(Pair(mean, variance)), _) => Tolerance::Given(ColorStats::uniform(mean, variance)),
                (None, Some(preset)) => Tolerance::Preset(preset.into()),
                (None, None) => Tolerance::Fitted,
            },
            template: if self.exact { Template::Exact } else { Template::Object },
        }
    }
}

fn in_one_line(landmark: &Landmark) -> String {
    let means = landmark.shades.iter().map(|shade| shade.mean.map(f32::round));
    let shades: Vec<String> = means.map(|[r, g, b]| format!("({r}, {g}, {b})")).collect();
    format!(
        "landmark {}, {}, mean colour {}, window {}×{}",
        landmark.id,
        landmark.shape.name(),
        shades.join(" and "),
        landmark.window_px.width,
        landmark.window_px.height
    )
}
