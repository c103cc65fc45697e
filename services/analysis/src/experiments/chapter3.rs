//! Chapter 3: edges, Hough transform and cross correlation on synthetic and on acquired data.

pub(super) mod acquired;
pub(super) mod synthetic;
