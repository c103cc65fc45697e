//! `waymark experiments`.

use std::path::{Path, PathBuf};

use analysis::experiments::{Lab, Verdict, conclusions, html, results, run as run_all, selected};
use anyhow::Context;

use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

const EXAMPLES: &str = "\
Examples:
  waymark experiments --report experiments
  waymark experiments --only 4.1,4.0.6 -o part

Into the directory go index.html, which needs nothing beside itself, and results.json: a list of objects with id (the \
figure's, table's or section's number and the quantity), thesis (a number, words, or null where it reports nothing), \
ours (a number, or null where it cannot be done again), unit and note.";

/// Do the thesis's experiments again, each beside what it reports
///
/// On its synthetic pictures, on the tables that it prints, and on simulated drives in place of its videos. The page
/// says which of its conclusions hold on these data, and which do not.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Only these: numbers of figures or tables (4.1), sections (4.0.6) or chapters (2), separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    only: Vec<String>,

    /// The directory that the page and results.json are written into; made where it is missing
    #[arg(long, short = 'o', visible_alias = "output", value_name = "DIR", default_value = "experiments")]
    report: PathBuf,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let experiments = selected(&args.only).or_usage()?;
    std::fs::create_dir_all(&args.report)
        .with_context(|| format!("cannot make the directory `{}`", args.report.display()))?;
    let bar = console.progress(experiments.len() as u64, "experiments");
    let done = run_all(&experiments, &Lab::default(), |_| bar.inc(1)).context("an experiment failed")?;
    bar.finish_and_clear();
    let page = args.report.join("index.html");
    write(&page, html(&done).as_bytes())?;
    let rows = results(&done);
    let json = serde_json::to_vec_pretty(&rows).context("cannot write the results as JSON")?;
    write(&args.report.join("results.json"), &json)?;
    let verdicts = conclusions(&done);
    let holding = verdicts.iter().filter(|conclusion| conclusion.verdict == Verdict::Holds).count();
    let pictures: usize = done.iter().map(|done| done.account.pictures.len()).sum();
    console.note(&format!(
        "{} experiments, {} results, {pictures} pictures; {holding} of {} conclusions hold: {}",
        done.len(),
        rows.len(),
        verdicts.len(),
        page.display()
    ));
    Ok(Ending::Fine)
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| format!("cannot write `{}`", path.display()))
}
