//! `waymark completion`.

use clap::CommandFactory;
use clap_complete::{Shell, generate};

use crate::cli::Cli;
use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Print a completion script for a shell
///
/// Example: waymark completion bash > ~/.local/share/bash-completion/completions/waymark
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The shell to complete in.
    shell: Shell,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut Cli::command(), "waymark", &mut script);
    Console::write_results(&script)?;
    Ok(Ending::Fine)
}
