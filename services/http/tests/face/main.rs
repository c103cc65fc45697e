//! The web face over real sockets.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop where it is")]

mod admission;
mod pictures;
mod pressure;
mod server;
mod shutdown;
