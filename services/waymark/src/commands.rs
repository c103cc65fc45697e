//! One file a command: its arguments, and what it does with them.

mod batch;
pub(crate) mod camera;
pub(crate) mod compare;
pub(crate) mod completion;
pub(crate) mod config;
pub(crate) mod demo;
pub(crate) mod doctor;
pub(crate) mod experiments;
pub(crate) mod explain;
pub(crate) mod follower;
pub(crate) mod landmark;
pub(crate) mod leader;
pub(crate) mod play;
pub(crate) mod recording;
pub(crate) mod register;
pub(crate) mod router;
mod service;

use crate::cli::{Cli, Command};
use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Runs the command that was asked for, to its end.
pub(crate) fn run(cli: Cli) -> Result<Ending, Failure> {
    let console = if cli.quiet { Console::Quiet } else { Console::Talkative };
    match cli.command {
        Command::Demo(args) => demo::run(&args, console),
        Command::Leader(args) => leader::run(&args),
        Command::Follower(args) => follower::run(&args),
        Command::Camera(args) | Command::Simulate(args) => camera::run(&args),
        Command::Play(args) => play::run(&args, console),
        Command::Router(args) => router::run(&args),
        Command::Landmark(command) => landmark::run(command, console),
        Command::Recording(command) => recording::run(command, console),
        Command::Compare(args) => compare::run(&args, console),
        Command::Experiments(args) => experiments::run(&args, console),
        Command::Explain(args) => explain::run(&args),
        Command::Register(args) => register::run(&args, console),
        Command::Doctor(args) => doctor::run(&args, console),
        Command::Config(command) => config::run(&command, console),
        Command::Completion(args) => completion::run(&args),
    }
}
