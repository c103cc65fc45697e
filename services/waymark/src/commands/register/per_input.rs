//! `register --into`: a table for each input, finished ones kept when a run is repeated.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use analysis::row::rows;
use analysis::table::RowWriter;
use anyhow::{Context, anyhow};

use super::names::FormatName;
use super::results::Seen;
use crate::commands::batch::{is_current, stems, unfinished};
use crate::exit::{Failure, OrUsage};

/// The tables of all inputs; they are written one after the other.
pub(super) struct PerInput {
    format: FormatName,
    /// The table of each input.
    targets: Vec<(String, PathBuf)>,
    /// The one that is being written.
    open: Option<OpenTable>,
}

struct OpenTable {
    given: String,
    target: PathBuf,
    writer: RowWriter<BufWriter<File>>,
}

impl PerInput {
    pub(super) fn begin(directory: &Path, inputs: &[String], format: FormatName) -> Result<Self, Failure> {
        for (at, given) in inputs.iter().enumerate() {
            if inputs[..at].contains(given) {
                return Err(Failure::Usage(anyhow!(
                    "--into takes each input once; `{given}` is given twice"
                )));
            }
        }
        fs::create_dir_all(directory)
            .with_context(|| format!("cannot make `{}`", directory.display()))
            .or_usage()?;
        let extension = match format {
            FormatName::Csv => "csv",
            FormatName::Ndjson => "ndjson",
        };
        let paths: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
        let names = stems(&paths).into_iter().map(|stem| directory.join(format!("{stem}.{extension}")));
        let targets = inputs.iter().cloned().zip(names).collect();
        Ok(Self { format, targets, open: None })
    }

    /// Whether an input's table is still to be written. Only of a file is it known whether it has changed.
    pub(super) fn is_due(&self, given: &str) -> bool {
        let input = Path::new(given);
        let current = |target: &Path| input.is_file() && is_current(target, input);
        !self.target(given).is_some_and(current)
    }

    pub(super) fn take(&mut self, seen: &Seen<'_>) -> anyhow::Result<()> {
        let given = &seen.input.given;
        if self.open.as_ref().is_none_or(|open| open.given != *given) {
            self.close()?;
            self.open = Some(self.begin_table(given)?);
        }
        if let Some(open) = &mut self.open {
            for row in rows(seen.key(), seen.outcome, seen.places) {
                open.writer.write(&row)?;
            }
        }
        Ok(())
    }

    pub(super) fn finish(mut self) -> anyhow::Result<()> {
        self.close()
    }

    fn target(&self, given: &str) -> Option<&Path> {
        self.targets.iter().find(|(input, _)| input == given).map(|(_, target)| target.as_path())
    }

    fn begin_table(&self, given: &str) -> anyhow::Result<OpenTable> {
        let target = self.target(given).ok_or_else(|| anyhow!("`{given}` has no table"))?.to_owned();
        let part = unfinished(&target);
        let file = File::create(&part).with_context(|| format!("cannot write `{}`", part.display()))?;
        let writer = RowWriter::new(self.format.into(), BufWriter::with_capacity(1 << 16, file))?;
        Ok(OpenTable { given: given.to_owned(), target, writer })
    }

    fn close(&mut self) -> anyhow::Result<()> {
        let Some(OpenTable { target, writer, .. }) = self.open.take() else { return Ok(()) };
        writer.finish()?;
        fs::rename(unfinished(&target), &target)
            .with_context(|| format!("cannot write `{}`", target.display()))
    }
}
