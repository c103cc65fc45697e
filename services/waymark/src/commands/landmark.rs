//! `waymark landmark`.

mod learn;
mod remote;
mod show;
mod tune;

use clap::Subcommand;

use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Learn, inspect and tune landmark files, and say to a running leader which to publish
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Learn(learn::Args),
    Show(show::Args),
    Tune(tune::Args),
    List(remote::List),
    Publish(remote::Publish),
    Retire(remote::Retire),
    Pull(remote::Pull),
    Push(remote::Push),
}

pub(crate) fn run(command: Command, console: Console) -> Result<Ending, Failure> {
    match command {
        Command::Learn(args) => learn::run(&args, console),
        Command::Show(args) => show::run(&args),
        Command::Tune(args) => tune::run(&args, console),
        Command::List(args) => remote::list(&args),
        Command::Publish(args) => remote::publish(&args, console),
        Command::Retire(args) => remote::retire(&args, console),
        Command::Pull(args) => remote::pull(&args, console),
        Command::Push(args) => remote::push(&args, console),
    }
}
