//! Registration of the leader's landmarks in live cameras.
//!
//! Pictures come in over Zenoh ([`run()`] puts it all together), each camera's own thread looks at the newest one, and
//! what it saw goes to the journal, to Zenoh, and to whoever looks at the page. Landmarks are what the leader says
//! they are ([`accepted`]); every picture and every loss is counted.

pub mod accepted;
mod burned_in;
mod calibration;
pub mod config;
mod counters;
mod error;
mod fleet_watch;
mod fps;
mod intake;
mod landmark_feed;
mod landmark_log;
mod leader_watch;
mod leftovers;
mod metrics;
mod outbound;
mod pictures_out;
mod post;
mod recordings;
mod results;
mod run;
pub mod seen_frame;
mod set_file;
mod state_log;
mod station;
pub mod status;
mod status_beacon;
mod tap;
mod topics;
mod web;
mod wire;

pub use config::FollowerConfig;
pub use error::FollowerError;
pub use run::{FollowerReport, run, run_on};
