//! End to end: what only shows when everything runs together, and rules about the repository as a whole.

#![allow(clippy::unwrap_used, clippy::print_stderr)] // all of this is test code: the lints know only #[test] functions

mod attacks;
mod convoy;
mod crash;
mod demo;
mod dependency_rule;
mod documented_commands;
mod fleet;
mod landmarks;
mod recorder;
mod tls;
mod video;
