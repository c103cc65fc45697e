//! Registration, prediction and following of landmarks in frames.
//!
//! This crate is pure: frames, numbers and time come in as arguments, results go out as values. It has no clock,
//! no I/O, no threads of its own, no logging and no serialisation; `clippy.toml` bans them with their reasons.
//!
//! The method is the statistical-gradient registration of the reference thesis, section 4.0.3. One frame passes
//! seven stages, each a function in a file of that name: [`statistics`] → [`mask`] → [`components`] → [`outline`]
//! → [`hough`] → [`shape`] → [`measure`]; [`mod@register`] runs them, [`follow`] runs [`mod@register`] over time.
//! What the method is compared with is in [`methods`].
//!
//! Conventions (ARCHITECTURE.md): frame pixels have their origin at the top-left **corner** of the picture, x to the
//! right, y down, so the centre of the first pixel is (0.5, 0.5); colours are 8-bit levels in the order R, G, B;
//! variances are the population's.

mod adaptive;
pub mod bitmask;
pub mod components;
pub mod doubled_grid;
#[cfg(test)]
mod drawn;
pub mod explain;
pub mod follow;
pub mod frame;
pub mod gate;
pub mod geometry;
pub mod hough;
pub mod landmark;
pub mod learn;
pub mod mask;
pub mod measure;
pub mod methods;
pub mod nearest;
pub mod outcome;
pub mod outline;
pub mod overlay;
pub mod pinhole;
pub mod predict;
pub mod probe;
#[doc(hidden)]
pub mod reference;
pub mod register;
pub mod score;
pub mod separation;
pub mod shape;
pub mod statistics;
pub mod timestamp;

pub use bitmask::{BitMask, Run};
pub use components::{Component, Components};
pub use explain::{Comparison, Explanation, explain};
pub use follow::{Follow, FollowOptions, FollowState, FrameStamp, Mode};
pub use frame::Frame;
pub use geometry::{PointPx, RectPx, Segment, SizePx};
pub use landmark::{ColorStats, Digest, Landmark, LandmarkSet, SetVersion, ShapeClass, WindowPx};
pub use learn::{LearnError, LearnOptions, learn};
pub use outcome::{Gate, LandmarkOutcome, Miss, Outcome, Prediction, Sighting};
pub use pinhole::{Pinhole, Place, places};
pub use probe::{NoProbe, Stage, StageProbe};
pub use register::{Request, ShapeVeto, Workspace, register, register_all};
pub use timestamp::Timestamp;
