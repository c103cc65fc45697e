//! Offline: register, learn, explain, compare and report over files and recordings.
//!
//! The same [`vision::follow::Follow`] as in a follower, fed from files instead of streams, so that what is found here
//! is what a vehicle finds. Nothing here prints: results are values, or go to a writer that the caller gives.

pub mod again;
pub mod chart;
mod chosen_pictures;
pub mod compare;
pub mod diff;
pub mod drive;
pub mod experiments;
pub mod export;
pub mod figures;
pub mod follow_choice;
pub mod input;
pub mod landmark_file;
pub mod learn;
pub mod lesson;
pub mod overlays;
mod page;
pub mod parquet_table;
pub mod recorded;
pub mod region;
pub mod register;
pub mod report;
pub mod row;
pub mod score;
mod sketch;
pub mod stage_times;
mod straight_lines;
pub mod strip;
pub mod table;
pub mod thumbnail;
pub mod truth;
pub mod tune;
