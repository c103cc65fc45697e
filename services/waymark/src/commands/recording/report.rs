//! `waymark recording report`.

use std::io::Write;
use std::path::{Path, PathBuf};

use analysis::drive::Drive;
use analysis::figures::Figures;
use analysis::report::{index, report};
use anyhow::{Context, anyhow};

use crate::commands::batch::{Batch, is_current, stems, told, write_whole};
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

const EXAMPLES: &str = "\
Examples:
  waymark recording report drive.mcap -o report.html
  waymark recording report drive.mcap --json
  waymark recording report 'recordings/*.mcap' -o reports/

Into a directory go a page and its figures (NAME.html, NAME.json) for each recording, index.html over all of them, and \
summary.json with the figures of all. What is newer than its recording is kept, so that an interrupted run goes on where \
it was when it is repeated.

Exit code 3 when parts of a recording are damaged, 1 when one could not be reported on at all.";

/// Report on recordings: what was registered, predicted, missed and lost, as a page and as figures
///
/// Tables and plots are those of the method's publication: results frame by frame, prediction error, centre and area
/// over time; with them the detection of each landmark over time, the worst frames as pictures, losses and gaps. Where
/// the recording holds a simulator's truth, detection rate and error of the centre too.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    batch: Batch,

    /// The page; a directory (made when it ends in /) for several recordings
    #[arg(long, short, value_name = "OUT", required_unless_present = "json")]
    output: Option<PathBuf>,

    /// Print the figures as JSON, one object for each recording
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let files = args.batch.recordings()?;
    let directory = args.directory(&files)?;
    let names = stems(&files);
    let bar = console.progress(files.len() as u64, "reporting");
    let results = args.batch.each(&files, &bar, |file| {
        let at = files.iter().position(|other| other == file).unwrap_or_default();
        let figures = match (&directory, &args.output) {
            (Some(directory), _) => into_directory(file, directory, &names[at])?,
            (None, Some(page)) => into_page(file, page)?,
            (None, None) => Figures::of(file, &Drive::read(file)?)?,
        };
        Ok((format!("{}.html", names[at]), figures))
    });
    bar.finish_and_clear();
    let (reports, failed) = told(results, console);
    if let Some(directory) = &directory {
        write_summary(directory, &reports)?;
    }
    if args.json {
        let mut out = Console::results();
        for (_, figures) in &reports {
            serde_json::to_writer(&mut out, figures).map_err(std::io::Error::from)?;
            writeln!(out)?;
        }
        out.flush()?;
    }
    let damaged = reports.iter().filter(|(_, figures)| !figures.damage.is_empty()).count();
    console.note(&format!(
        "{} recordings: {} reported on, {damaged} of them damaged, {failed} failed",
        files.len(),
        reports.len()
    ));
    match (failed, damaged) {
        (0, 0) => Ok(Ending::Fine),
        (0, _) => Ok(Ending::DataLost),
        _ => Err(Failure::Failed(anyhow!("{failed} of {} recordings could not be reported on", files.len()))),
    }
}

impl Args {
    /// Where several pages go; `None` for one page, or none.
    fn directory(&self, files: &[PathBuf]) -> Result<Option<PathBuf>, Failure> {
        let Some(output) = &self.output else { return Ok(None) };
        let is_directory = output.is_dir() || output.to_string_lossy().ends_with('/');
        match (is_directory, files.len()) {
            (true, _) => {
                std::fs::create_dir_all(output)
                    .with_context(|| format!("cannot make `{}`", output.display()))
                    .or_usage()?;
                Ok(Some(output.clone()))
            }
            (false, 1) => Ok(None),
            (false, _) => Err(Failure::Usage(anyhow!(
                "{} recordings need a directory for their pages: `-o {}/`",
                files.len(),
                output.display()
            ))),
        }
    }
}

fn into_page(file: &Path, page: &Path) -> anyhow::Result<Figures> {
    let report = report(file)?;
    write_whole(page, |mut out| Ok(out.write_all(report.html.as_bytes()).and_then(|()| out.flush())?))?;
    Ok(report.figures)
}

/// The page and its figures, made only where they are not there yet.
fn into_directory(file: &Path, directory: &Path, name: &str) -> anyhow::Result<Figures> {
    let (page, kept) = (directory.join(format!("{name}.html")), directory.join(format!("{name}.json")));
    if is_current(&page, file)
        && is_current(&kept, file)
        && let Ok(figures) = serde_json::from_slice(&std::fs::read(&kept)?)
    {
        return Ok(figures);
    }
    let figures = into_page(file, &page)?;
    write_json(&kept, &figures)?;
    Ok(figures)
}

fn write_summary(directory: &Path, reports: &[(String, Figures)]) -> anyhow::Result<()> {
    let figures: Vec<&Figures> = reports.iter().map(|(_, figures)| figures).collect();
    write_json(&directory.join("summary.json"), &figures)?;
    let page = index(reports);
    write_whole(&directory.join("index.html"), |mut out| {
        Ok(out.write_all(page.as_bytes()).and_then(|()| out.flush())?)
    })
}

fn write_json(path: &Path, value: &impl serde::Serialize) -> anyhow::Result<()> {
    write_whole(path, |mut out| {
        serde_json::to_writer_pretty(&mut out, value)?;
        writeln!(out)?;
        Ok(out.flush()?)
    })
}
