//! What real cameras need beyond the fixed statistics of thesis 4.0.3.
//!
//! A search marks the pixels that may show the landmark under the light of the moment ([`likeness`]), takes connected
//! ones as seeds, tells object from background ([`segment`]) and from its own shadow ([`shadow`]) around each, measures
//! with soft edges ([`soft_edge`]) and scores what came out ([`choose`]). Where to search and what to believe is for
//! `follow` to say.

mod board;
mod candidate;
pub(crate) mod choose;
mod coarse;
mod disc;
mod face;
pub(crate) mod like;
pub(crate) mod likeness;
pub(crate) mod memory;
mod mixture;
mod nearer;
mod neighbours;
pub(crate) mod noise;
pub(crate) mod palette;
pub(crate) mod patch;
mod seeds;
mod segment;
mod shadow;
pub(crate) mod sharpness;
mod soft_edge;
mod tracing;
mod window;
mod word;

pub(crate) use candidate::{Candidate, Finder, Search};
pub(crate) use coarse::Coarse;
pub(crate) use likeness::{Light, Likeness};
pub(crate) use tracing::Tracer;
