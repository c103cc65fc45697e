//! The end-to-end tests live in `main.rs`.
