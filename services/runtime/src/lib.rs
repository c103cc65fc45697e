//! What every service needs and nothing else: configuration layers, telemetry, shutdown, the Zenoh session, and
//! knowing who else is there.
//!
//! Nothing here knows a landmark, a frame or a message of ours; key expressions come in as arguments.

pub mod clock;
pub mod config;
pub mod identity;
pub mod link_trouble;
pub mod presence;
pub mod reply;
pub mod session;
pub mod shutdown;
pub mod telemetry;

pub use identity::{Identity, StateDir};
pub use session::SessionSettings;
pub use shutdown::Shutdown;
