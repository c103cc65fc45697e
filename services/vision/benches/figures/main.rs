//! `cargo bench -p vision --bench figures`: what the README states about speed, as tab-separated lines
//! `figure, content, width, height, window, count, microseconds`. `tests/bench` puts the OpenCV peer beside it.
//!
//! Thread CPU time; every figure is measured in several rounds over all figures, and the smallest counts, so that a busy
//! machine slows all of them or none. An argument selects figures whose line contains it; `--frames DIRECTORY` writes
//! the frames as raw RGB for other programs.
#![allow(missing_docs, reason = "a program")]
#![allow(dead_code, reason = "the scenes are shared with other benches")]
#![allow(clippy::print_stdout, reason = "its figures are its product")]

mod clock;
mod imageproc_peer;
#[path = "../scene/mod.rs"]
mod scene;
mod stages;
mod subjects;

use std::error::Error;

use clock::Rounds;

fn main() -> Result<(), Box<dyn Error>> {
    let filters = scene::arguments()?;
    let wanted = |line: &str| filters.iter().all(|part| line.contains(part.as_str()));
    let mut rounds = Rounds::default();
    subjects::add_all(&mut rounds, &wanted);
    for (line, smallest_us) in rounds.measure() {
        println!("{line}\t{smallest_us:.2}");
    }
    Ok(())
}
