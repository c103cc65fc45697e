//! How the program ends: exit codes, and errors with their causes.

use std::io::{self, Write};
use std::process::ExitCode;

/// How a command that ran to its end ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Everything that went in came out.
    Fine,
    /// It finished, but something was lost on the way; what, it said on stderr.
    DataLost,
}

/// Why a command did not run to its end.
#[derive(Debug)]
pub(crate) enum Failure {
    /// What was asked for cannot be done: arguments, configuration, or input files.
    Usage(anyhow::Error),
    /// It was tried and failed.
    Failed(anyhow::Error),
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Failed(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Failed(error.into())
    }
}

/// Errors that are the caller's to mend.
pub(crate) trait OrUsage<T> {
    /// The same result, its error counted as one of usage.
    fn or_usage(self) -> Result<T, Failure>;
}

impl<T, E: Into<anyhow::Error>> OrUsage<T> for Result<T, E> {
    fn or_usage(self) -> Result<T, Failure> {
        self.map_err(|error| Failure::Usage(error.into()))
    }
}

/// The exit code for this end, having told stderr what went wrong.
pub(crate) fn code_of(end: Result<Ending, Failure>) -> ExitCode {
    match end {
        Ok(Ending::Fine) => ExitCode::SUCCESS,
        Ok(Ending::DataLost) => ExitCode::from(3),
        Err(Failure::Failed(error)) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(Failure::Failed(error)) => {
            tell(&error);
            ExitCode::from(1)
        }
        Err(Failure::Usage(error)) => {
            tell(&error);
            ExitCode::from(2)
        }
    }
}

/// Whoever read our output has seen enough (`waymark … | head`): not a failure.
fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let kinds = error.chain().filter_map(|cause| cause.downcast_ref::<io::Error>());
    kinds.into_iter().any(|cause| cause.kind() == io::ErrorKind::BrokenPipe)
}

fn tell(error: &anyhow::Error) {
    let mut text = format!("error: {error}\n");
    for cause in error.chain().skip(1) {
        text.push_str(&format!("  because: {cause}\n"));
    }
    // Nothing can be told when stderr itself is gone; the exit code still says it.
    let _ = io::stderr().write_all(text.as_bytes());
}
