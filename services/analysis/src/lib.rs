//! Offline: register, learn, explain, compare and report over files and recordings.
//!
//! The same [`vision::follow::Follow`] as in a follower, fed from files instead of streams, so that what is found here
//! is what a vehicle finds. Nothing here prints: results are values, or go to a writer that the caller gives.

pub mod follow_choice;
pub mod input;
pub mod landmark_file;
pub mod learn;
pub mod overlays;
pub mod region;
pub mod register;
pub mod row;
pub mod score;
pub mod stage_times;
pub mod table;
pub mod truth;
pub mod tune;
