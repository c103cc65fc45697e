//! One file a command: its arguments, and what it does with them.

pub(crate) mod completion;
pub(crate) mod landmark;
pub(crate) mod recording;
pub(crate) mod register;

use crate::cli::{Cli, Command};
use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Runs the command that was asked for, to its end.
pub(crate) fn run(cli: Cli) -> Result<Ending, Failure> {
    let console = if cli.quiet { Console::Quiet } else { Console::Talkative };
    match cli.command {
        Command::Landmark(command) => landmark::run(command, console),
        Command::Recording(command) => recording::run(command, console),
        Command::Register(args) => register::run(&args, console),
        Command::Completion(args) => completion::run(&args),
    }
}
