//! Crash-safe MCAP recordings: writing, reading, recovery. Synchronous; knows nothing of Zenoh.
