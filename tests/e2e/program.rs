//! A running `waymark`.

use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fd::OwnedFd;
use rustix::process::{Pid, PidfdFlags, Signal, pidfd_open, pidfd_send_signal};

use crate::{DEADLINE, waymark};

/// A started program; killed when dropped.
pub struct Program {
    child: Child,
    pidfd: OwnedFd,
    stdout: Option<JoinHandle<String>>,
    notes: Arc<Notes>,
}

/// How a program ended.
#[derive(Debug)]
pub struct Ended {
    /// The exit code; absent after a signal.
    pub code: Option<i32>,
    /// All of its standard output.
    pub stdout: String,
    /// All lines of its standard error.
    pub notes: Vec<String>,
}

/// Lines of standard error, and news of more.
#[derive(Default)]
struct Notes {
    lines: Mutex<(Vec<String>, bool)>,
    more: Condvar,
}

impl Program {
    /// Starts `waymark` with these arguments.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Self {
        let mut command = Command::new(waymark());
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap_or_else(|error| panic!("waymark does not start: {error}"));
        let pidfd =
            pidfd_open(Pid::from_child(&child), PidfdFlags::empty()).unwrap_or_else(|e| panic!("pidfd: {e}"));
        let stdout = child.stdout.take().map(|mut stdout| {
            thread::spawn(move || {
                let mut text = String::new();
                let _incomplete = stdout.read_to_string(&mut text);
                text
            })
        });
        let notes = Arc::new(Notes::default());
        if let Some(stderr) = child.stderr.take() {
            let notes = Arc::clone(&notes);
            thread::spawn(move || notes.collect(BufReader::new(stderr)));
        }
        Self { child, pidfd, stdout, notes }
    }

    /// The first line of standard error that contains `text`; waits for it.
    ///
    /// # Panics
    /// When it does not come.
    #[must_use]
    pub fn note(&self, text: &str) -> String {
        self.notes.first_with(text)
    }

    /// The operating system's number of the process.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Asks it to end, as a service manager does.
    ///
    /// # Panics
    /// When the signal cannot be sent.
    pub fn terminate(&self) {
        self.signal(Signal::TERM);
    }

    /// Ends it at once, as a power cut does.
    ///
    /// # Panics
    /// When the signal cannot be sent.
    pub fn kill(&self) {
        self.signal(Signal::KILL);
    }

    /// Ends it at once and waits until nothing is left of it: until then the kernel still holds its locks.
    ///
    /// # Panics
    /// When the signal cannot be sent, or it does not end.
    pub fn cut_power(self) {
        self.kill();
        let _ended_by_a_signal = self.ended_within(DEADLINE);
    }

    /// Stops it where it is: its connections stay, and it neither reads nor answers.
    ///
    /// # Panics
    /// When the signal cannot be sent.
    pub fn freeze(&self) {
        self.signal(Signal::STOP);
    }

    /// Lets it go on.
    ///
    /// # Panics
    /// When the signal cannot be sent.
    pub fn thaw(&self) {
        self.signal(Signal::CONT);
    }

    /// Waits for its end.
    ///
    /// # Panics
    /// When it is still running after `limit`.
    #[must_use]
    pub fn ended_within(mut self, limit: Duration) -> Ended {
        let timeout = Timespec { tv_sec: limit.as_secs().try_into().unwrap_or(i64::MAX), tv_nsec: 0 };
        let ended = poll(&mut [PollFd::new(&self.pidfd, PollFlags::IN)], Some(&timeout));
        assert!(matches!(ended, Ok(1..)), "still running after {limit:?}; it said:\n{}", self.notes.text());
        let status = self.child.wait().unwrap_or_else(|error| panic!("no exit status: {error}"));
        let stdout = self.stdout.take().and_then(|reader| reader.join().ok()).unwrap_or_default();
        Ended { code: status.code(), stdout, notes: self.notes.all() }
    }

    fn signal(&self, signal: Signal) {
        pidfd_send_signal(&self.pidfd, signal).unwrap_or_else(|error| panic!("{signal:?}: {error}"));
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _already_ended = self.child.kill();
        let _reaped = self.child.wait();
    }
}

impl Ended {
    /// Standard output and error, for a failed assertion.
    #[must_use]
    pub fn transcript(&self) -> String {
        format!("exit code {:?}\n{}\n{}", self.code, self.stdout, self.notes.join("\n"))
    }
}

impl Notes {
    fn collect(&self, stderr: impl BufRead) {
        for line in stderr.lines().map_while(Result::ok) {
            self.lock().0.push(line);
            self.more.notify_all();
        }
        self.lock().1 = true;
        self.more.notify_all();
    }

    fn first_with(&self, text: &str) -> String {
        let deadline = Instant::now() + DEADLINE;
        let mut guard = self.lock();
        loop {
            if let Some(line) = guard.0.iter().find(|line| line.contains(text)) {
                return line.clone();
            }
            let left = deadline.saturating_duration_since(Instant::now());
            assert!(!guard.1 && !left.is_zero(), "no line with {text:?} in:\n{}", guard.0.join("\n"));
            (guard, _) = self.more.wait_timeout(guard, left).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Every line, once the program has closed its standard error.
    fn all(&self) -> Vec<String> {
        let guard = self.lock();
        let closed = self.more.wait_timeout_while(guard, DEADLINE, |lines| !lines.1);
        closed.unwrap_or_else(PoisonError::into_inner).0.0.clone()
    }

    fn text(&self) -> String {
        self.lock().0.join("\n")
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, (Vec<String>, bool)> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
