//! Video there and back, and what becomes of it when it is damaged.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests may; the helpers of tests are none to the lint"
)]

mod clips;
mod damage;
mod films;
mod pictures;
mod streams;
