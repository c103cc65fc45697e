//! Chapter 4: statistical-gradient registration.

pub(super) mod blocks;
pub(super) mod disturbances;
pub(super) mod doubling;
pub(super) mod green_signs;
pub(super) mod prediction;
pub(super) mod printed_tables;
pub(super) mod random_segments;
pub(super) mod search_area;
pub(super) mod stop_sign;
pub(super) mod synthetic;
pub(super) mod tolerances;
