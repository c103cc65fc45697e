//! Recordings, published again under the keys they came from, at their recorded times, byte for byte.
//!
//! A thread of its own waits for the time of each message ([`tempo`] says when that is); another reads ahead. State
//! (landmarks, manifest, calibrations) is published before the first message of each start, so that a follower that
//! sees the middle of a drive knows what to look for.

mod control;
mod error;
mod reel;
mod run;
mod stage;
pub mod tempo;
mod web;

pub use control::{Command, Control, Status};
pub use error::PlayError;
pub use reel::PlayedMessage;
pub use run::{PlayOptions, PlayReport, play};
pub use stage::Remap;
pub use web::routes;
