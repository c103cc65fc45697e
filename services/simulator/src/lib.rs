//! Worlds with exact ground truth, seen through rendered cameras on moving vehicles.
