//! The terminal: results to stdout, notes and progress to stderr. Nothing else in the workspace writes to either.

use std::io::{self, BufWriter, IsTerminal, StdoutLock, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// What the program may say besides its results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Console {
    /// Notes and, on a terminal, progress.
    Talkative,
    /// Only results and errors.
    Quiet,
}

impl Console {
    /// Writes a result that is complete.
    pub(crate) fn write_results(bytes: &[u8]) -> io::Result<()> {
        let mut stdout = io::stdout().lock();
        stdout.write_all(bytes)?;
        stdout.flush()
    }

    /// Where a result that grows goes; the caller flushes it.
    pub(crate) fn results() -> BufWriter<StdoutLock<'static>> {
        BufWriter::with_capacity(1 << 16, io::stdout().lock())
    }

    /// The same for a writer that goes from thread to thread.
    pub(crate) fn results_unlocked() -> BufWriter<io::Stdout> {
        BufWriter::with_capacity(1 << 16, io::stdout())
    }

    /// Something worth knowing that is not a result.
    pub(crate) fn note(self, text: &str) {
        if self == Self::Talkative {
            self.warn(text);
        }
    }

    /// Something that went wrong without ending the command; `--quiet` does not silence it.
    pub(crate) fn warn(self, text: &str) {
        // A closed stderr must not end a run whose results go elsewhere.
        let _ = writeln!(io::stderr(), "{text}");
    }

    /// A bar over `len` steps: hidden unless stderr is a terminal.
    pub(crate) fn progress(self, len: u64, what: &'static str) -> ProgressBar {
        let hidden = self == Self::Quiet || !io::stderr().is_terminal();
        let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(len), target).with_message(what);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {per_sec} eta {eta}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }
}
