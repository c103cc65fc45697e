//! Worlds with exact ground truth, seen through rendered cameras on moving vehicles.
//!
//! Seen from outside this is a camera: [`Simulator::render`] gives frame after frame, each with the truth about every
//! named object in it. A scene builds a world (two textured planes, shadows, solids, a vehicle's path) from its seed;
//! one renderer draws any world: exact perspective, exact edge coverage, exposure swing, shake, motion blur of the
//! single things, and sensor noise; on demand all that makes a film worse. The truth comes from the same geometry, not
//! from the picture.
//!
//! Nothing here has a clock or a thread; the same options and frame number give the same bytes.

mod camera;
mod drive;
mod options;
mod pattern;
mod polygon;
mod render;
mod scene;
mod simulator;
mod solids;
mod texture;
mod truth;
mod vector;
mod world;

pub use camera::Intrinsics;
pub use options::{Look, OptionsError, SceneKind, SceneOptions};
pub use simulator::{Rendered, Simulator};
pub use truth::TrueObject;
