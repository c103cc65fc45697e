//! The landmark set, published to Zenoh with a manifest, and its web face.
//!
//! `book` decides what the set is, `memory` keeps it from one start to the next, `publication` turns it into
//! messages, `answers` gives them to whoever asks and `announcements` to whoever listens; all changes are made at one
//! `desk`, and [`run()`] puts them together. [`client`] is the other side: what the command line says to a running leader. [`store`] remembers the sets of
//! all leaders for a router.

mod announcements;
mod answers;
pub mod book;
mod camera_watch;
pub mod client;
pub mod config;
mod desk;
pub mod error;
mod handle;
pub mod landmark_files;
mod lessons;
mod memory;
mod metrics;
mod publication;
mod put_times;
mod run;
mod status;
pub mod store;
mod web;

pub use book::{Change, Edit, Others, RefusedEdit};
pub use config::LeaderConfig;
pub use error::LeaderError;
pub use handle::{EditError, LeaderHandle};
pub use run::{Leader, LeaderReport, run};
pub use status::EditCounts;
