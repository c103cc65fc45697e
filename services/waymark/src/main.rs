//! The one binary: argument parsing, then the service or the analysis that was asked for.

mod cli;
mod columns;
mod commands;
mod console;
mod exit;

use std::process::ExitCode;

use clap::Parser;

use crate::cli::Cli;

fn main() -> ExitCode {
    let cli = Cli::parse();
    exit::code_of(commands::run(cli))
}
