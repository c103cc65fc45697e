//! A picture source, published to Zenoh.
//!
//! Seen from the others a simulator, a directory of pictures and a recording are the same thing: a camera.

mod coder;
mod config;
mod error;
mod publishing;
mod run;
mod shots;

pub use config::{AtEnd, CameraConfig, H264Config, SentEncoding};
pub use error::CameraError;
pub use run::{CameraReport, run};
