//! The built program, as people and scripts use it: arguments in, text and exit code out.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

mod access;
mod compare;
mod config;
mod convoy;
mod doctor;
mod experiments;
mod landmarks;
mod program;
mod recordings;
mod reference;
mod register;
mod scene;
mod usage;
