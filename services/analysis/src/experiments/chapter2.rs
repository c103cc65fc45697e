//! Chapter 2: digital image processing.

pub(super) mod aperture;
pub(super) mod convolution;
pub(super) mod correlation;
pub(super) mod filters;
pub(super) mod flow;
pub(super) mod hough_lines;
pub(super) mod interpolation;
pub(super) mod parameter_space;
pub(super) mod registration;
pub(super) mod sobel;
