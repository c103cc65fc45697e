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
//! Fourier transforms are those of `realfft` and `rustfft`. The rest is our own. `imageproc` has many of these filters,
//! but brings a random number generator and the C library with it, which this crate does without; it stays a peer in
//! the benches. Where it was looked at for correctness: its Hough transform truncates ρ towards zero, so that one bin is
//! twice as wide, and does not join 0° to 180°; its template matching is a direct sum; it has no sub-pixel phase
//! correlation, no dense flow and no registration by control points. `image`'s cubic filter widens with the scale, which
//! is right for thumbnails, but is not the interpolation of eq. 2.11.

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
