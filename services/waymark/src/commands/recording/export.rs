//! `waymark recording export`.

use std::io::Write;
use std::path::{Path, PathBuf};

use analysis::export::{
    Exported, Pictures, TableFormat, TableKind, TableWriter, export_pictures, export_table,
};
use analysis::overlays::Overlays;
use analysis::table::RowFormat;
use anyhow::{Context, anyhow};
use clap::ValueEnum;
use indicatif::HumanCount;

use crate::commands::batch::{Batch, is_current, stems, told, write_whole};
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

const EXAMPLES: &str = "\
Examples:
  waymark recording export drive.mcap > drive.csv
  waymark recording export 'recordings/*.mcap' --format parquet -o tables/
  waymark recording export drive.mcap --table truth --format parquet -o truth.parquet
  waymark recording export drive.mcap --frames frames --overlays drawn
  waymark recording export drive.mcap --overlays drive.mp4

Columns of registrations are those of `waymark register`; of truth: input, frame, captured_at_ns, camera, object, x_px, \
y_px, area_px2, visible.

Into a directory goes one table for each recording, with its name. A table that is newer than its recording is kept, so \
that an interrupted run goes on where it was when it is repeated. Pictures are written anew.

Exit code 3 when parts of a recording are damaged and missing from the result, 1 when a recording could not be exported \
at all.";

/// Write what recordings hold as tables and pictures
///
/// Without -o, --frames and --overlays the table goes to standard output.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    batch: Batch,

    /// How the table is written
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,

    /// What the table is of
    #[arg(long, value_enum, default_value_t = Table::Registrations)]
    table: Table,

    /// The table's file; a directory (made when it ends in /) for one table each
    #[arg(long, short, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Write every picture as it was recorded into this directory
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,

    /// Write every picture that was registered, with the recorded result drawn in: as a JPEG into this directory, or as a
    /// film (H.264)
    #[arg(long, value_name = "DIR|FILE.mp4")]
    overlays: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Comma-separated values with a header line
    Csv,
    /// One JSON object a line, null where unknown
    Ndjson,
    /// Columns for DuckDB, DataFusion and Spark
    Parquet,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Table {
    /// What was registered
    Registrations,
    /// What a simulator really showed
    Truth,
}

/// What came of one recording.
#[derive(Default)]
struct Done {
    rows: u64,
    pictures: u64,
    damaged: u64,
    kept: u64,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let files = args.batch.recordings()?;
    let targets = args.targets(&files)?;
    let pictures = args.pictures()?;
    if targets.is_none() && pictures.is_none() {
        return args.to_stdout(&files);
    }
    let bar = console.progress(files.len() as u64, "exporting");
    let results = args.batch.each(&files, &bar, |file| {
        let at = files.iter().position(|other| other == file).unwrap_or_default();
        let number = (files.len() > 1).then_some(at + 1);
        args.export(file, targets.as_ref().map(|targets| targets[at].as_path()), number, pictures.as_ref())
    });
    bar.finish_and_clear();
    let (done, failed) = told(results, console);
    let sum = |of: fn(&Done) -> u64| done.iter().map(of).sum::<u64>();
    let (rows, pictures, kept, damaged) =
        (sum(|d| d.rows), sum(|d| d.pictures), sum(|d| d.kept), sum(|d| d.damaged));
    console.note(&format!(
        "{} recordings: {} rows, {} pictures; {kept} tables were there already, {damaged} damaged parts, {failed} failed",
        files.len(),
        HumanCount(rows),
        HumanCount(pictures)
    ));
    match (failed, damaged) {
        (0, 0) => Ok(Ending::Fine),
        (0, _) => Ok(Ending::DataLost),
        _ => Err(Failure::Failed(anyhow!("{failed} of {} recordings could not be exported", files.len()))),
    }
}

impl Args {
    /// The table of each recording; `None` when no table is written to files.
    fn targets(&self, files: &[PathBuf]) -> Result<Option<Vec<PathBuf>>, Failure> {
        let Some(output) = &self.output else {
            let nowhere = self.format == Format::Parquet && self.frames.is_none() && self.overlays.is_none();
            return match nowhere {
                true => Err(Failure::Usage(anyhow!("a Parquet table needs a file: say where with -o"))),
                false => Ok(None),
            };
        };
        let into_directory = output.is_dir() || output.to_string_lossy().ends_with('/');
        match (into_directory, files.len()) {
            (true, _) => {
                std::fs::create_dir_all(output)
                    .with_context(|| format!("cannot make `{}`", output.display()))
                    .or_usage()?;
                let name = |stem: String| output.join(format!("{stem}.{}", self.format.extension()));
                Ok(Some(stems(files).into_iter().map(name).collect()))
            }
            (false, 1) => Ok(Some(vec![output.clone()])),
            (false, _) => Err(Failure::Usage(anyhow!(
                "{} recordings need a directory for their tables: `-o {}/`",
                files.len(),
                output.display()
            ))),
        }
    }

    fn pictures(&self) -> Result<Option<Pictures>, Failure> {
        if self.frames.is_none() && self.overlays.is_none() {
            return Ok(None);
        }
        if let Some(frames) = &self.frames {
            std::fs::create_dir_all(frames)
                .with_context(|| format!("cannot make `{}`", frames.display()))
                .or_usage()?;
        }
        let overlays = self.overlays.clone().map(Overlays::to).transpose().or_usage()?;
        Ok(Some(Pictures { frames: self.frames.clone(), overlays }))
    }

    fn to_stdout(&self, files: &[PathBuf]) -> Result<Ending, Failure> {
        let mut table = self.writer(Console::results_unlocked())?;
        let mut damaged = 0;
        for file in files {
            damaged += export_table(file, &file.to_string_lossy(), &mut table).or_usage()?.damaged;
        }
        table.finish().map_err(anyhow::Error::from)?;
        Ok(if damaged > 0 { Ending::DataLost } else { Ending::Fine })
    }

    fn export(
        &self,
        file: &Path,
        target: Option<&Path>,
        number: Option<usize>,
        pictures: Option<&Pictures>,
    ) -> anyhow::Result<Done> {
        let mut done = Done::default();
        match target {
            Some(target) if is_current(target, file) => done.kept = 1,
            Some(target) => {
                let Exported { written, damaged } = write_whole(target, |out| self.table(file, out))?;
                (done.rows, done.damaged) = (written, damaged);
            }
            None => {}
        }
        if let Some(pictures) = pictures {
            let Exported { written, damaged } = export_pictures(file, number, pictures)?;
            done.pictures = written;
            done.damaged = done.damaged.max(damaged);
        }
        Ok(done)
    }

    fn table(&self, file: &Path, out: impl Write + Send) -> anyhow::Result<Exported> {
        let mut table = self.writer(out)?;
        let exported = export_table(file, &file.to_string_lossy(), &mut table)?;
        table.finish()?;
        Ok(exported)
    }

    fn writer<W: Write + Send>(&self, out: W) -> anyhow::Result<TableWriter<W>> {
        let kind = match self.table {
            Table::Registrations => TableKind::Registrations,
            Table::Truth => TableKind::Truth,
        };
        let format = match self.format {
            Format::Csv => TableFormat::Text(RowFormat::Csv),
            Format::Ndjson => TableFormat::Text(RowFormat::Ndjson),
            Format::Parquet => TableFormat::Parquet,
        };
        Ok(TableWriter::new(kind, format, out)?)
    }
}

impl Format {
    const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Ndjson => "ndjson",
            Self::Parquet => "parquet",
        }
    }
}
