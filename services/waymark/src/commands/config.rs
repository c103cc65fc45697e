//! `waymark config`.

mod acl;
mod check;
mod schema;
mod show;

use clap::Subcommand;

use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Show, check and describe the configuration of the services
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Show(show::Args),
    Check(check::Args),
    Schema(schema::Args),
    Acl(acl::Args),
}

/// A service that is configured by files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Service {
    /// `waymark leader`
    Leader,
    /// `waymark follower`
    Follower,
    /// `waymark camera` and `waymark simulate`
    Camera,
}

pub(crate) fn run(command: &Command, console: Console) -> Result<Ending, Failure> {
    match command {
        Command::Show(args) => show::run(args),
        Command::Check(args) => check::run(args, console),
        Command::Schema(args) => schema::run(args),
        Command::Acl(args) => acl::run(args),
    }
}
