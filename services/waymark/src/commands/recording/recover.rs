//! `waymark recording recover`.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use indicatif::{HumanBytes, HumanCount};
use recording::recover::{RecoverReport, recover};
use recording::{RecordingError, WriterOptions};

use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Write a valid recording with everything that can be read of a damaged one
///
/// The damaged file stays as it is. Exit code 0 when everything in it could be kept, 3 when something was lost.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: waymark recording recover drive.mcap.active -o drive.mcap")]
pub(crate) struct Args {
    /// The damaged recording
    file: PathBuf,

    /// The new recording; must not exist yet
    #[arg(long, short, value_name = "OUT")]
    output: PathBuf,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    if args.output.exists() {
        return Err(Failure::Usage(anyhow!(
            "`{}` exists already; recovery overwrites nothing, name another file",
            args.output.display()
        )));
    }
    let report = match recover(&args.file, &args.output, &WriterOptions::default()) {
        Err(error @ RecordingError::NotMcap(_)) => Err(error).or_usage()?,
        other => other.map_err(anyhow::Error::from)?,
    };
    for fault in &report.faults {
        console.warn(&format!("damage {fault}"));
    }
    console.note(&in_one_line(&args.output, &report));
    Ok(if report.lost_data() { Ending::DataLost } else { Ending::Fine })
}

fn in_one_line(output: &Path, report: &RecoverReport) -> String {
    let lost = match report.cut_bytes {
        0 if report.lost_data() => "; damaged parts are lost".to_owned(),
        0 => String::new(),
        bytes => format!("; {} after the last whole record are lost", HumanBytes(bytes)),
    };
    let (messages, chunks) = (HumanCount(report.messages), HumanCount(report.chunks));
    format!("{}: {messages} messages in {chunks} chunks kept{lost}", output.display())
}
