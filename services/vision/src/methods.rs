//! The other methods of the reference thesis, chapters 2 and 3: what the registration of section 4.0.3 is compared with.
//!
//! Each file is one method with its equations, and works on any input: pictures of any size, none included. They take
//! a [`Frame`](crate::Frame) where a method knows colours, else a [`Plane`] of brightness.
//!
//! | thesis | here |
//! | --- | --- |
//! | 2.1, eq. 2.4 | [`Plane::of`] |
//! | 2.2, eqs. 2.5–2.8 | [`convolve`](mod@convolve), [`fourier`] |
//! | 2.3 | [`low_pass`](low_pass::low_pass), [`gaussian`](low_pass::gaussian), [`median`](mod@median) |
//! | 2.4, eqs. 2.10, 2.11 | [`interpolate`] |
//! | 2.5, eqs. 2.12–2.17 | [`gradient`](mod@gradient), [`canny`] |
//! | 2.6, eqs. 2.18, 2.19 | [`hough`] |
//! | 2.7.3, eqs. 2.20, 2.21 | [`control_points`] |
//! | 2.7.3, frequency | [`phase_correlation`] |
//! | 2.7.4, eq. 2.22 | [`ncc`] |
//! | 2.8, eqs. 2.23–2.37 | [`horn_schunck`] |
//!
//! Fourier transforms are those of `realfft` and `rustfft`. The rest is our own. `imageproc` 0.27 has many of these methods,
//! but brings a random number generator and the C library with it, which this crate does without; it stays a peer of the
//! benches (`tests/bench-methods`). And of what it has, these would not do:
//!
//! - its mean filter cuts off fractions twice, once along x and once along y, which darkens by up to two levels;
//! - its filters and medians know odd windows only, and whole levels (Fig 2.1 has a median of 2 × 2);
//! - its normalised cross correlation is not eq. 2.22: means are not taken away, so every bright window is alike; it is
//!   summed up directly, and panics where the template is as large as the picture;
//! - its Canny smooths with a fixed width, and panics on thresholds in the wrong order;
//! - its Hough transform truncates ρ towards zero, so that one bin is twice as wide, knows whole degrees only, does not
//!   join 0° to 180°, and does not tell a line's votes;
//! - its maps between pictures are projections, not the bilinear model of eqs. 2.20 and 2.21;
//! - it has no convolution by Fourier transforms, no phase correlation and no dense flow.
//!
//! The cubic filter of `image` widens where a picture shrinks, which suits thumbnails, but is not eq. 2.11.

pub mod border;
pub mod canny;
pub mod control_points;
pub mod convolve;
pub mod fourier;
pub mod gradient;
pub mod horn_schunck;
pub mod hough;
pub mod interpolate;
pub mod low_pass;
pub mod median;
pub mod ncc;
pub mod phase_correlation;
pub mod plane;
#[cfg(test)]
mod reference;

pub use border::Border;
pub use canny::Canny;
pub use control_points::BilinearMap;
pub use convolve::{Extent, convolve};
pub use gradient::{Gradient, Operator, gradient};
pub use horn_schunck::{Flow, HornSchunck};
pub use hough::{HoughTransform, Line};
pub use interpolate::Interpolation;
pub use median::median;
pub use ncc::{Colours, Match, Ncc, NccError, NccOptions};
pub use phase_correlation::{PhaseCorrelator, Shift, Taper};
pub use plane::{Intensity, Plane, SizesDiffer};
