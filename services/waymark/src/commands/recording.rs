//! `waymark recording`.

mod check;
mod export;
mod info;
mod recover;
mod report;

use clap::Subcommand;

use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Look into recordings (MCAP), check and recover them
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Info(info::Args),
    Check(check::Args),
    Recover(recover::Args),
    Export(export::Args),
    Report(report::Args),
}

pub(crate) fn run(command: Command, console: Console) -> Result<Ending, Failure> {
    match command {
        Command::Info(args) => info::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Recover(args) => recover::run(&args, console),
        Command::Export(args) => export::run(&args, console),
        Command::Report(args) => report::run(&args, console),
    }
}
