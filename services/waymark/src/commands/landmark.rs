//! `waymark landmark`.

mod learn;
mod show;

use clap::Subcommand;

use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Learn and inspect landmark files
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Learn(learn::Args),
    Show(show::Args),
}

pub(crate) fn run(command: Command, console: Console) -> Result<Ending, Failure> {
    match command {
        Command::Learn(args) => learn::run(args, console),
        Command::Show(args) => show::run(&args, console),
    }
}
