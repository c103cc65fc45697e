//! Driving the real binary: start it, read what it says, ask its web face, end it.
//!
//! Nothing here sleeps: waiting is for a line, an event, an exit, each with a deadline that only a failure reaches.

pub mod face;
pub mod program;

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// When a wait is given up. Far beyond what anything takes, so that a busy machine does not fail a test.
pub const DEADLINE: Duration = Duration::from_secs(60);

/// The root of the repository.
#[must_use]
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or_else(|| Path::new("/"))
}

/// The binary under test: `WAYMARK_BIN`, or the one built beside this test.
///
/// # Panics
/// When there is none.
#[must_use]
pub fn waymark() -> PathBuf {
    let built = || Some(std::env::current_exe().ok()?.parent()?.parent()?.join("waymark"));
    let path = std::env::var_os("WAYMARK_BIN").map(PathBuf::from).or_else(built).unwrap_or_default();
    assert!(
        path.is_file(),
        "no binary at {}: run `cargo build -p waymark`, or set WAYMARK_BIN",
        path.display()
    );
    path
}

/// An address on the loopback that nobody listens on.
///
/// # Panics
/// When the operating system has none left.
#[must_use]
pub fn free_address() -> String {
    let listener = TcpListener::bind(("127.0.0.1", 0));
    let address = listener.and_then(|listener| listener.local_addr());
    address.unwrap_or_else(|error| panic!("no free address: {error}")).to_string()
}

/// Pause between two looks at something that announces nothing.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Looks again and again until there is something to see: for what nobody tells the moment of.
///
/// # Panics
/// When there never is.
pub fn until<T>(what: &str, look: impl Fn() -> Option<T>) -> T {
    let deadline = Instant::now() + DEADLINE;
    loop {
        if let Some(seen) = look() {
            return seen;
        }
        assert!(Instant::now() < deadline, "{what}: not within {DEADLINE:?}");
        std::thread::park_timeout(BETWEEN_LOOKS);
    }
}
