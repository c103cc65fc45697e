//! Plays: waits for the time of each message, and does what is asked meanwhile.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use recording::RecordingError;
use tokio::sync::watch;
use zenoh::Session;

use crate::control::{Command, Control, Status};
use crate::error::PlayError;
use crate::reel::{PlayedMessage, Reel};
use crate::stage::{Remap, Stage};
use crate::tempo::{Rate, Tempo};

/// Commands that may wait.
const WAITING_COMMANDS: usize = 16;

/// How often the status is renewed while nothing is published.
const STATUS_EVERY: Duration = Duration::from_millis(100);

/// How recordings are played.
#[derive(Clone, Debug)]
pub struct PlayOptions {
    /// The recordings.
    pub files: Vec<PathBuf>,
    /// How fast.
    pub rate: Rate,
    /// Where to begin, from the beginning of the first recording.
    pub start: Duration,
    /// Begins again at the end, from `start`.
    pub repeat: bool,
    /// Waits to be resumed.
    pub paused: bool,
    /// Other keys.
    pub remaps: Vec<Remap>,
}

/// What a player leaves behind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlayReport {
    /// Its last status.
    pub status: Status,
    /// How late each of the newest messages was against its time, ns, oldest first.
    pub lateness_ns: Vec<u64>,
}

/// How many of the newest messages' lateness is kept.
const KEPT_LATENESS: usize = 1 << 16;

/// Starts to play. The thread ends at the end of the recordings, or when asked to.
///
/// # Errors
/// When a recording cannot be read, or nothing is in any.
pub fn play(
    options: PlayOptions,
    session: Session,
) -> Result<(Control, JoinHandle<Result<PlayReport, PlayError>>), PlayError> {
    let reel = Reel::open(&options.files)?.ok_or(PlayError::Nothing)?;
    let (commands, asked) = sync_channel(WAITING_COMMANDS);
    let duration_s = reel.duration_ns().map(|duration_ns| Duration::from_nanos(duration_ns).as_secs_f64());
    let report = PlayReport { status: Status { duration_s, ..Status::default() }, ..PlayReport::default() };
    let (status, watched) = watch::channel(report.status);
    let stage = Stage::new(session, options.remaps.clone());
    let position_ns = reel.begins_ns.saturating_add(options.start.as_nanos() as u64);
    let mut tempo = Tempo::new(options.rate, position_ns, Instant::now());
    tempo.set_paused(options.paused, position_ns, Instant::now());
    let player = Player { options, reel, stage, tempo, position_ns, report, status, told_at: None };
    let thread = std::thread::Builder::new().name("player".to_owned()).spawn(move || player.run(&asked))?;
    Ok((Control { commands, status: watched }, thread))
}

struct Player {
    options: PlayOptions,
    reel: Reel,
    stage: Stage,
    tempo: Tempo,
    /// The recorded moment that was reached.
    position_ns: u64,
    report: PlayReport,
    status: watch::Sender<Status>,
    told_at: Option<Instant>,
}

/// Why playing from one place came to an end.
enum Cut {
    /// The recordings did.
    End,
    /// It goes on elsewhere.
    Seek(u64),
    /// It was asked to stop.
    Stop,
}

impl Player {
    fn run(mut self, asked: &Receiver<Command>) -> Result<PlayReport, PlayError> {
        loop {
            self.tempo.anchor(self.position_ns, Instant::now());
            let messages = self.reel.read_ahead(self.position_ns)?;
            match self.play_from_here(&messages, asked)? {
                Cut::Stop => break,
                Cut::Seek(position_ns) => self.position_ns = position_ns,
                Cut::End if self.options.repeat => {
                    self.position_ns = self.start_ns();
                    self.report.status.rounds += 1;
                }
                Cut::End => break,
            }
            self.stage.cut();
        }
        self.tell();
        Ok(self.report)
    }

    fn start_ns(&self) -> u64 {
        self.reel.begins_ns.saturating_add(self.options.start.as_nanos() as u64)
    }

    fn play_from_here(
        &mut self,
        messages: &Receiver<Result<PlayedMessage, RecordingError>>,
        asked: &Receiver<Command>,
    ) -> Result<Cut, PlayError> {
        let mut first = true;
        while let Ok(next) = messages.recv() {
            let next = next?;
            let recorded_ns = next.message.log_time_ns;
            if first && !next.is_state {
                // What was being read meanwhile has cost no recorded time.
                self.tempo.anchor(self.position_ns, Instant::now());
                first = false;
            }
            if !next.is_state
                && let Some(cut) = self.wait_for(recorded_ns, asked)
            {
                return Ok(cut);
            }
            self.stage.publish(&next)?;
            self.report.status.published += 1;
            if !next.is_state {
                self.note_lateness(recorded_ns);
                self.position_ns = recorded_ns;
            }
            self.tell_now_and_then();
        }
        Ok(Cut::End)
    }

    /// Waits until a recorded moment is due, doing what is asked.
    fn wait_for(&mut self, recorded_ns: u64, asked: &Receiver<Command>) -> Option<Cut> {
        loop {
            let now = Instant::now();
            let command = match self.tempo.due(recorded_ns) {
                Some(due) if due <= now => match asked.try_recv() {
                    Ok(command) => command,
                    Err(TryRecvError::Empty) => return None,
                    Err(TryRecvError::Disconnected) => return Some(Cut::Stop),
                },
                due => {
                    let wait = due.map_or(STATUS_EVERY, |due| due - now).min(STATUS_EVERY);
                    match asked.recv_timeout(wait) {
                        Ok(command) => command,
                        Err(RecvTimeoutError::Timeout) => {
                            self.tell_now_and_then();
                            continue;
                        }
                        Err(RecvTimeoutError::Disconnected) => return Some(Cut::Stop),
                    }
                }
            };
            if let Some(cut) = self.obey(command) {
                return Some(cut);
            }
            self.tell();
        }
    }

    fn obey(&mut self, command: Command) -> Option<Cut> {
        let now = Instant::now();
        let paused = self.tempo.is_paused();
        match command {
            Command::Pause => self.tempo.set_paused(true, self.position_ns, now),
            Command::Resume => self.tempo.set_paused(false, self.position_ns, now),
            Command::Toggle => self.tempo.set_paused(!paused, self.position_ns, now),
            Command::Rate(rate) => self.tempo.set_rate(rate, self.position_ns, now),
            Command::Scale(factor) => {
                self.tempo.set_rate(self.tempo.rate().scaled(factor), self.position_ns, now);
            }
            Command::Seek(to) => {
                return Some(Cut::Seek(self.reel.begins_ns.saturating_add(to.as_nanos() as u64)));
            }
            Command::Skip(seconds) => {
                let to_ns = self.position_ns as f64 + seconds * 1e9;
                return Some(Cut::Seek((to_ns as u64).max(self.reel.begins_ns)));
            }
            Command::Stop => return Some(Cut::Stop),
        }
        None
    }

    fn note_lateness(&mut self, recorded_ns: u64) {
        let late = self.tempo.due(recorded_ns).map(|due| Instant::now().saturating_duration_since(due));
        if self.report.lateness_ns.len() == KEPT_LATENESS {
            self.report.lateness_ns.clear();
        }
        self.report.lateness_ns.extend(late.map(|late| u64::try_from(late.as_nanos()).unwrap_or(u64::MAX)));
    }

    fn tell_now_and_then(&mut self) {
        if self.told_at.is_none_or(|at| at.elapsed() >= STATUS_EVERY) {
            self.tell();
        }
    }

    fn tell(&mut self) {
        self.told_at = Some(Instant::now());
        let status = &mut self.report.status;
        status.paused = self.tempo.is_paused();
        status.rate = self.tempo.rate().get();
        status.position_s =
            Duration::from_nanos(self.position_ns.saturating_sub(self.reel.begins_ns)).as_secs_f64();
        self.status.send_replace(*status);
    }
}
