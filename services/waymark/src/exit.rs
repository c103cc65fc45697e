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
    /// It looked for damage, and there is some; what, its result says.
    Damaged,
    /// It compared, and there are differences; which, its result says.
    Different,
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
        Ok(Ending::Damaged | Ending::Different) => ExitCode::from(1),
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
pub(crate) fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let kinds = error.chain().filter_map(|cause| cause.downcast_ref::<io::Error>());
    kinds.into_iter().any(|cause| cause.kind() == io::ErrorKind::BrokenPipe)
}

fn tell(error: &anyhow::Error) {
    // Nothing can be told when stderr itself is gone; the exit code still says it.
    let _ = io::stderr().write_all(told(error).as_bytes());
}

/// The error and its causes, a line each; a cause that an error above it already quotes is not repeated.
fn told(error: &anyhow::Error) -> String {
    let mut last = error.to_string();
    let mut text = format!("error: {last}\n");
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !last.contains(&cause) {
            text.push_str(&format!("  because: {cause}\n"));
            last = cause;
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::{Context, anyhow};

    #[test]
    fn causes_are_told_once() {
        let error = anyhow!("disk full").context("cannot write: disk full").context("no recording");
        assert_eq!(told(&error), "error: no recording\n  because: cannot write: disk full\n");
    }

    #[test]
    fn a_reader_that_went_away_is_no_failure() {
        let gone: Result<(), _> = Err(io::Error::from(io::ErrorKind::BrokenPipe));
        assert!(is_closed_pipe(&gone.context("cannot write the table").unwrap_err()));
        assert!(!is_closed_pipe(&anyhow!("broken pipe")));
    }
}
