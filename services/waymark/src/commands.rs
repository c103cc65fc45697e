//! One file a command: its arguments, and what it does with them.

pub(crate) mod completion;

use crate::cli::{Cli, Command};
use crate::exit::{Ending, Failure};

/// Runs the command that was asked for, to its end.
pub(crate) fn run(cli: Cli) -> Result<Ending, Failure> {
    match cli.command {
        Command::Completion(args) => completion::run(&args),
    }
}
