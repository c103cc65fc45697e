//! The terminal: results to stdout, notes and progress to stderr. Nothing else in the workspace writes to either.

use std::io::{self, Write};

/// What the program may say besides its results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Console;

impl Console {
    /// Writes results that are complete.
    pub(crate) fn write_results(bytes: &[u8]) -> io::Result<()> {
        let mut stdout = io::stdout().lock();
        stdout.write_all(bytes)?;
        stdout.flush()
    }
}
