//! Where the results of `register` go: a table, or what differs from the recording; and the recording written again.

use std::collections::BTreeMap;
use std::io::{BufWriter, StdoutLock};
use std::sync::Arc;

use analysis::again::AgainWriter;
use analysis::input::{Frames, Input, Past};
use analysis::row::{FrameKey, rows};
use analysis::table::RowWriter;
use anyhow::{Context, anyhow};
use vision::{LandmarkSet, Outcome, Place};

use super::Args;
use super::differences::Differences;
use super::per_input::PerInput;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage, is_closed_pipe};

/// One frame's result.
pub(super) struct Seen<'a> {
    pub(super) input: &'a Input,
    /// Counts from 1 within its input and camera.
    pub(super) frame: u64,
    pub(super) camera: Option<&'a Arc<str>>,
    pub(super) outcome: &'a Outcome,
    /// Where that is, as far as known.
    pub(super) places: &'a [Place],
    /// What the recording holds of the live result.
    pub(super) recorded: Option<Past>,
}

impl Seen<'_> {
    pub(super) fn key(&self) -> FrameKey<'_> {
        let camera = self.camera.map(AsRef::as_ref);
        FrameKey { input: &self.input.given, frame: Some(self.frame), camera }
    }
}

/// Where results go.
pub(super) struct Results {
    table: Table,
    again: Option<AgainWriter>,
    /// Landmarks that are not the recording's own.
    landmarks: Option<Arc<LandmarkSet>>,
}

enum Table {
    Rows(RowWriter<BufWriter<StdoutLock<'static>>>),
    Differences(Box<Differences>),
    PerInput(PerInput),
    /// Whoever read the table has seen enough, but the recording is to be written; how that ends.
    Unread(Ending),
}

impl Results {
    pub(super) fn begin(
        args: &Args,
        tables: Option<PerInput>,
        inputs: &[(Input, Frames)],
        landmarks: Option<Arc<LandmarkSet>>,
    ) -> Result<Self, Failure> {
        let table = match (tables, args.diff) {
            (Some(tables), _) => Table::PerInput(tables),
            (None, true) => Table::Differences(Box::new(Differences::begin(args.format.into(), inputs)?)),
            (None, false) => Table::Rows(
                RowWriter::new(args.format.into(), Console::results()).context("cannot write the table")?,
            ),
        };
        Ok(Self { table, again: again(args, inputs)?, landmarks })
    }

    pub(super) fn take(&mut self, seen: &Seen<'_>) -> anyhow::Result<()> {
        if let (Some(again), Some(camera)) = (&mut self.again, seen.camera) {
            again.add(seen.frame, camera, seen.outcome, seen.places)?;
        }
        match self.table.take(seen) {
            Err(error) if self.again.is_some() && is_closed_pipe(&error) => {
                self.table = self.table.unread();
                Ok(())
            }
            taken => taken,
        }
    }

    /// Finishes the files; says whether anything differs from the recording, where that was asked.
    pub(super) fn finish(self, args: &Args, console: Console) -> anyhow::Result<Ending> {
        if let Some(again) = self.again {
            let report = again.finish(how(args), self.landmarks.as_deref())?;
            let (messages, output) = (indicatif::HumanCount(report.messages), report.output.display());
            console.note(&format!("{output}: {messages} old messages and the new results"));
            report.faults.iter().for_each(|fault| console.warn(&format!("damage {fault}")));
        }
        match self.table {
            Table::Rows(writer) => {
                writer.finish().context("cannot write the table")?;
                Ok(Ending::Fine)
            }
            Table::Differences(differences) => differences.finish(console),
            Table::PerInput(tables) => tables.finish().map(|()| Ending::Fine),
            Table::Unread(ending) => Ok(ending),
        }
    }
}

impl Table {
    fn take(&mut self, seen: &Seen<'_>) -> anyhow::Result<()> {
        match self {
            Table::Rows(writer) => {
                for row in rows(seen.key(), seen.outcome, seen.places) {
                    writer.write(&row)?;
                }
                Ok(())
            }
            Table::Differences(differences) => differences.take(seen),
            Table::PerInput(tables) => tables.take(seen),
            Table::Unread(_) => Ok(()),
        }
    }

    /// What is left of it when nobody reads it any more. Differences are only written where something differs.
    fn unread(&self) -> Self {
        Table::Unread(match self {
            Table::Differences(_) => Ending::Different,
            _ => Ending::Fine,
        })
    }
}

fn again(args: &Args, inputs: &[(Input, Frames)]) -> Result<Option<AgainWriter>, Failure> {
    let Some(output) = &args.output else { return Ok(None) };
    match inputs {
        [(input, _)] if let Some((file, topic)) = input.recording() => {
            AgainWriter::begin(file, output, topic).map(Some).or_usage()
        }
        _ => {
            Err(Failure::Usage(anyhow!("-o writes one recording again; give exactly one recording with it")))
        }
    }
}

/// How the results were made, as the new recording tells it.
fn how(args: &Args) -> BTreeMap<String, String> {
    let options = [
        ("mode", args.mode.map(|mode| format!("{mode:?}").to_lowercase())),
        ("prediction", args.prediction.map(|method| format!("{method:?}").to_lowercase())),
        ("require_shape", args.require_shape.then(|| "true".to_owned())),
    ];
    let chosen = options
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value.unwrap_or_else(|| "as recorded".to_owned())));
    let own = if args.landmarks.is_empty() { "the recording's own" } else { "landmarks.again.json" };
    let told = [("version", env!("CARGO_PKG_VERSION")), ("landmarks", own)];
    chosen.chain(told.map(|(name, value)| (name.to_owned(), value.to_owned()))).collect()
}
