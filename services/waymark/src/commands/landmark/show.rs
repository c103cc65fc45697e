//! `waymark landmark show`.

use std::path::PathBuf;

use analysis::landmark_file::{landmark_text, read_landmark};
use anyhow::Context;
use vision::{ColorStats, Landmark};

use crate::columns::Columns;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Show what a landmark file says
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Landmark files
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Print the landmark as JSON, its digest and every default filled in
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    for path in &args.files {
        let landmark = read_landmark(path).or_usage()?;
        let text = match args.json {
            true => landmark_text(&landmark).context("cannot write the landmark as JSON")?,
            false => described(&landmark),
        };
        Console::write_results(text.as_bytes())?;
    }
    Ok(Ending::Fine)
}

fn described(landmark: &Landmark) -> String {
    let size = landmark.size_m.map_or_else(|| "size unknown".to_owned(), |size_m| format!("{size_m} m wide"));
    let mut text = format!(
        "{}  shape {}, {size}, window {}×{} on the doubled grid, revision {}\ndigest {}\n",
        landmark.id,
        landmark.shape.name(),
        landmark.window_px.width,
        landmark.window_px.height,
        landmark.revision,
        landmark.digest
    );
    for (number, shade) in (1..).zip(&landmark.shades) {
        text.push_str(&format!("\nshade {number} of {}\n", landmark.shades.len()));
        text.push_str(&statistics(shade, &landmark.tolerance));
    }
    text
}

/// The six statistics, each with its unit, its tolerance and what that accepts.
fn statistics(expected: &ColorStats, tolerance: &ColorStats) -> String {
    let mut table = Columns::new(["statistic", "unit", "expected", "±", "accepted from", "to"]);
    let groups = [
        ("mean", "levels", expected.mean, tolerance.mean),
        ("variance", "levels²", expected.variance, tolerance.variance),
    ];
    for (name, unit, expected, tolerance) in groups {
        for (channel, (value, off)) in
            ["red", "green", "blue"].into_iter().zip(expected.into_iter().zip(tolerance))
        {
            let limits = [(value - off).max(0.0), value + off];
            let numbers = [value, off, limits[0], limits[1]].map(|number| format!("{number:.1}"));
            table.row([format!("{name} {channel}"), unit.to_owned()].into_iter().chain(numbers));
        }
    }
    table.text()
}
