//! `waymark explain`.

use std::path::{Path, PathBuf};

use analysis::landmark_file::read_landmark;
use analysis::learn::read_frame;
use anyhow::Context;
use vision::explain::{Comparison, Explanation, explain};
use vision::frame::encode::{Quality, encode_jpeg, encode_png};
use vision::outcome::{Adaptation, Statistic};
use vision::overlay::{Layers, draw};
use vision::{Frame, Landmark, Outcome, Prediction};

use crate::columns::Columns;
use crate::commands::register::ModeName;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

const EXAMPLES: &str = "\
Example: waymark explain drive/f120.jpg --landmark red.json --picture why.png";

/// Say why a landmark was or was not registered in a picture, statistic by statistic
///
/// The six statistics are those at the place where the landmark was registered or, where it was not, at the place that
/// came nearest. Nothing is known from earlier frames.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// The picture (JPEG, PNG)
    frame: PathBuf,

    /// Landmark file
    #[arg(long, short, value_name = "FILE")]
    landmark: PathBuf,

    /// How the frame is searched
    #[arg(long, value_enum, default_value_t = ModeName::Adaptive)]
    mode: ModeName,

    /// Write the picture with the explanation drawn in: PNG, or JPEG where the name ends in .jpg
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let landmark = read_landmark(&args.landmark).or_usage()?;
    let mut frame = read_frame(&args.frame).or_usage()?;
    let explanation = explain(&frame, &landmark, args.mode.into());
    let text = format!("{}: {}\n", args.frame.display(), described(&landmark, &explanation));
    Console::write_results(text.as_bytes())?;
    if let Some(path) = &args.picture {
        draw_into(&mut frame, &explanation, &landmark);
        write_picture(&frame, path)?;
    }
    Ok(Ending::Fine)
}

fn described(landmark: &Landmark, explanation: &Explanation) -> String {
    let mut text = verdict(landmark, explanation);
    let Some(at) = explanation.at else { return text };
    let (shade, shades) = (explanation.shade + 1, landmark.shades.len());
    let place = if explanation.outcome.result.is_ok() { "there" } else { "where it came nearest" };
    text.push_str(&format!(
        "\n\nStatistics {place}, at {:.1}, {:.1}, against shade {shade} of {shades}:\n",
        at.x, at.y
    ));
    text.push_str(statistics(&explanation.statistics).trim_end());
    if let Some(adaptation) = &explanation.outcome.adaptation {
        text.push_str("\n\nAdapted to this picture:\n");
        text.push_str(adapted(adaptation).trim_end());
    }
    if !explanation.others.is_empty() {
        text.push_str("\n\nObjects registered, by score; the first one is explained:\n");
        text.push_str(candidates(explanation).trim_end());
    }
    if explanation.outcome.result.is_ok() && !explanation.failures().is_empty() {
        text.push_str("\n\nRegistered all the same: adaptive mode follows light, noise and scale.");
    }
    text
}

fn adapted(adaptation: &Adaptation) -> String {
    let Adaptation { gain, haze, noise_variance: [red, green, blue], window_px, tolerance_scale, full_frame } =
        *adaptation;
    let mut table = Columns::new(["what", "value", "meaning"]);
    let searched = if full_frame { "whole frame" } else { "gate" };
    for row in [
        ["gain", &format!("{gain:.2}"), "brightness over the descriptor's"],
        ["haze", &format!("{haze:+.1}"), "white added to the descriptor's colours, levels"],
        ["noise", &format!("{red:.1} {green:.1} {blue:.1}"), "variance of the camera, levels², taken out"],
        ["window", &format!("{window_px}"), "samples on a side, of the doubled grid"],
        ["tolerance", &format!("{tolerance_scale:.2}"), "times the descriptor's for means"],
        ["searched", searched, "nothing is known from earlier frames"],
    ] {
        table.row(row.map(str::to_owned));
    }
    table.text()
}

fn candidates(explanation: &Explanation) -> String {
    let mut table = Columns::new(["object", "x", "y", "px²", "shape fit", "distinctness", "score"]);
    for outcome in std::iter::once(&explanation.outcome).chain(&explanation.others) {
        let Ok(seen) = &outcome.result else { continue };
        table.row([
            outcome.instance.to_string(),
            format!("{:.1}", seen.centroid.x),
            format!("{:.1}", seen.centroid.y),
            format!("{:.0}", seen.area_px2),
            seen.shape_score.map_or("too small".to_owned(), |fit| format!("{fit:.2}")),
            format!("{:.2}", seen.distinctness),
            format!("{:.2}", seen.score),
        ]);
    }
    table.text()
}

fn verdict(landmark: &Landmark, explanation: &Explanation) -> String {
    let shape = match explanation.shape_score {
        Some(fit) => format!("outline fits {} to {fit:.2}", landmark.shape.name()),
        None => "too small to show a shape".to_owned(),
    };
    match &explanation.outcome.result {
        Ok(seen) => format!(
            "{} registered at {:.1}, {:.1}; {:.0} px², {shape}, score {:.2}",
            landmark.id, seen.centroid.x, seen.centroid.y, seen.area_px2, seen.score
        ),
        Err(_) => {
            format!("{} not registered: {}", landmark.id, explanation.reason().unwrap_or_default())
        }
    }
}

fn statistics(comparisons: &[Comparison]) -> String {
    let mut table = Columns::new(["statistic", "unit", "observed", "expected", "±", "off / ±", ""]);
    for Comparison { statistic, observed, expected, tolerance, excess } in comparisons {
        let unit = if matches!(statistic, Statistic::Mean(_)) { "levels" } else { "levels²" };
        let numbers = [observed, expected, tolerance].map(|number| format!("{number:.1}"));
        let verdict = if *excess > 1.0 { "fails" } else { "fits" };
        table.row(
            [statistic.in_words(), unit.to_owned()]
                .into_iter()
                .chain(numbers)
                .chain([format!("{excess:.2}"), verdict.to_owned()]),
        );
    }
    table.text()
}

/// Draws the outcome; a miss gets its cross where it came nearest.
fn draw_into(frame: &mut Frame, explanation: &Explanation, landmark: &Landmark) {
    let mut outcome = explanation.outcome.clone();
    if let (Err(_), Some(at)) = (&outcome.result, explanation.at) {
        let window_px2 = f32::from(landmark.window_px.width) * f32::from(landmark.window_px.height) / 4.0;
        outcome.prediction = Some(Prediction { centroid: at, area_px2: window_px2, ..Prediction::default() });
    }
    let landmarks = std::iter::once(outcome).chain(explanation.others.iter().cloned()).collect();
    let all = Outcome { frame_size: frame.size(), landmarks, ..Outcome::default() };
    draw(frame, &all, Layers::ALL);
}

fn write_picture(frame: &Frame, path: &Path) -> anyhow::Result<()> {
    let is_jpeg =
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("jpg") || e.eq_ignore_ascii_case("jpeg"));
    let encoded = if is_jpeg { encode_jpeg(frame, Quality::default()) } else { encode_png(frame) };
    let bytes = encoded.context("cannot encode the picture")?;
    std::fs::write(path, bytes).with_context(|| format!("cannot write `{}`", path.display()))
}
