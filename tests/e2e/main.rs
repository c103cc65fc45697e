//! End to end: what only shows when everything runs together, and rules about the repository as a whole.

#![allow(clippy::unwrap_used)] // all of this is test code; the lint's own exception only knows #[test] functions

mod dependency_rule;
mod documented_commands;
