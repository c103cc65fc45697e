//! `waymark recording check`.

use std::path::PathBuf;

use indicatif::HumanCount;
use recording::check::{Check, Verdict, check};

use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Check recordings: structure, checksums, schemas, times, losses
///
/// Exit code 0 when every file is whole, 3 when a valid file says or shows that data was lost, 1 when one is damaged.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Print the findings as JSON, one object for each file
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let mut worst = Verdict::Fine;
    for path in &args.files {
        let found = check(path).or_usage()?;
        worst = worst.max(found.verdict());
        Console::write_results(if args.json { json(&found) } else { described(&found) }.as_bytes())?;
    }
    match worst {
        Verdict::Fine => Ok(Ending::Fine),
        Verdict::DataLost => Ok(Ending::DataLost),
        Verdict::Damaged => Ok(Ending::Damaged),
    }
}

fn described(found: &Check) -> String {
    let path = found.path.display();
    let mut text = match found.verdict() {
        Verdict::Fine => format!("{path}: fine\n"),
        Verdict::DataLost => format!("{path}: valid, but data was lost\n"),
        Verdict::Damaged => format!("{path}: damaged\n"),
    };
    for finding in &found.findings {
        text.push_str(&format!("  {finding}\n"));
    }
    if found.unlisted > 0 {
        text.push_str(&format!("  and {} more of the same kinds\n", HumanCount(found.unlisted)));
    }
    text
}

fn json(found: &Check) -> String {
    let object = serde_json::json!({
        "path": found.path,
        "verdict": found.verdict(),
        "findings": found.findings,
        "unlisted": found.unlisted,
    });
    format!("{object}\n")
}
