//! The command line as a whole; each command's arguments stand in its own file.

use clap::{Parser, Subcommand};

use crate::commands::{
    camera, compare, completion, config, demo, doctor, experiments, explain, follower, landmark, leader,
    play, recording, register, router,
};

/// What stands below the options.
const EXIT_CODES: &str = "Exit codes: 0 fine, 1 failed, 2 usage or configuration, 3 finished with data lost.";

/// Landmark registration for leader-follower convoys
///
/// A lead vehicle names landmarks by six colour statistics; following vehicles find them in their own cameras and
/// record what they saw. Coordinates are frame pixels: origin at the top-left corner, x right, y down, centre of the
/// first pixel at (0.5, 0.5).
#[derive(Debug, Parser)]
#[command(name = "waymark", version, after_help = EXIT_CODES)]
pub(crate) struct Cli {
    /// No progress and no notes: only results, warnings and errors
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,

    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(demo::Args),
    Leader(leader::Args),
    Follower(follower::Args),
    Camera(camera::Args),
    /// Publish a simulated camera; the same as `camera`, whose default source is a simulator
    Simulate(camera::Args),
    Play(play::Args),
    Router(router::Args),
    #[command(subcommand)]
    Landmark(landmark::Command),
    Register(register::Args),
    Explain(explain::Args),
    Compare(compare::Args),
    Experiments(experiments::Args),
    #[command(subcommand)]
    Recording(recording::Command),
    Doctor(doctor::Args),
    #[command(subcommand)]
    Config(config::Command),
    Completion(completion::Args),
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
