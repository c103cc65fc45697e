//! Offline: register, learn, explain, compare and report over files and recordings.
