//! What may be asked of a player while it plays, and what it says of itself.

use std::sync::mpsc::SyncSender;
use std::time::Duration;

use serde::Serialize;
use tokio::sync::watch;

use crate::tempo::Rate;

/// Something asked of a player.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Stops where it is.
    Pause,
    /// Goes on.
    Resume,
    /// Stops, or goes on.
    Toggle,
    /// Plays at another rate.
    Rate(Rate),
    /// Plays so many times as fast as now, within what [`Rate`] allows.
    Scale(f64),
    /// Goes on from there, counted from the beginning; state is published anew.
    Seek(Duration),
    /// Goes so many seconds forward, or back.
    Skip(f64),
    /// Ends.
    Stop,
}

/// What a player says of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Status {
    /// Whether it is stopped.
    pub paused: bool,
    /// Recorded seconds per second; 0 for as fast as possible.
    pub rate: f64,
    /// Recorded seconds from the beginning.
    pub position_s: f64,
    /// Recorded seconds from the beginning to the last message; `None` where a recording has no summary.
    pub duration_s: Option<f64>,
    /// Messages published, state of each start included.
    pub published: u64,
    /// How often it began again.
    pub rounds: u64,
}

/// The handle of a running player.
#[derive(Clone, Debug)]
pub struct Control {
    pub(crate) commands: SyncSender<Command>,
    pub(crate) status: watch::Receiver<Status>,
}

impl Control {
    /// Asks something; false when the player has ended or was asked too much at once.
    #[must_use]
    pub fn ask(&self, command: Command) -> bool {
        self.commands.try_send(command).is_ok()
    }

    /// Waits until it says something new; `None` once it has ended.
    pub async fn next_status(&mut self) -> Option<Status> {
        self.status.changed().await.ok()?;
        Some(*self.status.borrow_and_update())
    }

    /// What it says of itself, at most a tenth of a second old.
    #[must_use]
    pub fn status(&self) -> Status {
        *self.status.borrow()
    }
}
