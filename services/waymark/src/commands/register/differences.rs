//! `register --diff`: the results held against what the recordings say was seen live.

use std::collections::BTreeSet;
use std::io::{BufWriter, StdoutLock};

use analysis::diff::{DiffRow, DiffTally, changes, diff_row};
use analysis::input::{Frames, Input};
use analysis::recorded::RecordedOutcomes;
use analysis::table::{RowFormat, RowWriter};
use anyhow::{Context, anyhow};

use super::results::Seen;
use crate::columns::Columns;
use crate::console::Console;
use crate::exit::{Ending, Failure};

/// The comparison under way; inputs are compared one after the other.
pub(super) struct Differences {
    writer: RowWriter<BufWriter<StdoutLock<'static>>>,
    tally: DiffTally,
    /// The input that is being compared, and its recorded results.
    recorded: Option<(String, RecordedOutcomes)>,
}

impl Differences {
    pub(super) fn begin(format: RowFormat, inputs: &[(Input, Frames)]) -> Result<Self, Failure> {
        let mut given = BTreeSet::new();
        for (input, _) in inputs {
            let name = &input.given;
            if input.recording().is_none() {
                return Err(Failure::Usage(anyhow!("--diff compares with recordings, and `{name}` is none")));
            }
            if !given.insert(name) {
                return Err(Failure::Usage(anyhow!(
                    "--diff takes each recording once; `{name}` is given twice"
                )));
            }
        }
        let writer = RowWriter::with_columns(format, Console::results(), &DiffRow::COLUMNS);
        let writer = writer.context("cannot write the table")?;
        Ok(Self { writer, tally: DiffTally::default(), recorded: None })
    }

    pub(super) fn take(&mut self, seen: &Seen<'_>) -> anyhow::Result<()> {
        let recorded = match seen.recorded {
            Some(past) => self.recorded(seen)?.map(|outcome| (past, outcome)),
            None => None,
        };
        let Some((past, recorded)) = recorded else {
            self.tally.without_result += 1;
            return Ok(());
        };
        let changes = changes(&recorded, seen.outcome);
        self.tally.count(past, &changes);
        for change in &changes {
            self.writer.write(&diff_row(seen.key(), seen.outcome.captured_at.nanos, past, change))?;
        }
        Ok(())
    }

    pub(super) fn finish(self, console: Console) -> anyhow::Result<Ending> {
        self.writer.finish().context("cannot write the table")?;
        console.note(&told(&self.tally));
        Ok(if self.tally.different > 0 { Ending::Different } else { Ending::Fine })
    }

    fn recorded(&mut self, seen: &Seen<'_>) -> anyhow::Result<Option<vision::Outcome>> {
        let given = &seen.input.given;
        let known = self.recorded.as_ref().is_some_and(|(known, _)| known == given);
        if !known && let Some((file, topic)) = seen.input.recording() {
            self.recorded = Some((given.clone(), RecordedOutcomes::open(file, topic)?));
        }
        let camera = seen.camera.map_or("", AsRef::as_ref);
        let stamp = (seen.outcome.captured_at, seen.outcome.sequence);
        match &mut self.recorded {
            Some((_, outcomes)) => Ok(outcomes.take(camera, stamp.0, stamp.1)?),
            None => Ok(None),
        }
    }
}

/// The summary.
fn told(tally: &DiffTally) -> String {
    let DiffTally { compared, different, without_past, different_without_past, without_result, .. } = tally;
    let mut text = match different {
        0 => format!("{compared} frames compared: equal in every field"),
        _ => format!("{compared} frames compared: {different} differ"),
    };
    if *without_past > 0 {
        text.push_str(&format!(
            "\n{without_past} frames rest on pictures that are not in the file: {different_without_past} differ, not judged"
        ));
    }
    if *without_result > 0 {
        text.push_str(&format!("\n{without_result} frames have no recorded result to compare with"));
    }
    if !tally.fields.is_empty() {
        let mut table = Columns::new(["field", "changes", "largest difference"]);
        for (field, tally) in &tally.fields {
            let largest = tally.largest.map_or_else(|| "–".to_owned(), |largest| format!("{largest:.4}"));
            table.row([(*field).to_owned(), tally.changes.to_string(), largest]);
        }
        text.push('\n');
        text.push_str(table.text().trim_end());
    }
    text
}
