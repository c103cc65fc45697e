//! Section 2.7.3: registration by control points (equations 2.20, 2.21) and by phase correlation.

use vision::methods::control_points::ControlPoint;
use vision::methods::phase_correlation::Taper;
use vision::methods::{BilinearMap, Border, Intensity, Interpolation, PhaseCorrelator, Plane};
use vision::{PointPx, RectPx, SizePx};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::picture::{grey, heat};
use crate::experiments::{ExperimentError, Lab};

/// Part of the rink's frame that is shifted about.
const PART: RectPx = RectPx { x: 120, y: 160, width: 256, height: 192 };

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let plane = Plane::of(&lab.rink_frame()?, Intensity::Luma);
    let mut account = Account::default();
    let whole = shift_error(&plane, 9.0, -5.0, &mut account)?;
    let half = shift_error(&plane, 3.5, 2.5, &mut account)?;
    account.compare(
        "phase correlation, whole pixels",
        Thesis::Words("the peak is the shift"),
        whole,
        "px",
        "error of a shift by (9, −5) of a part of the rink's frame",
    );
    account.compare(
        "phase correlation, half pixels",
        Thesis::Silent,
        half,
        "px",
        "error of a shift by (3.5, 2.5)",
    );
    let (fitted, warped) = control_points(&plane)?;
    account.compare(
        "control points, error elsewhere",
        Thesis::Silent,
        fitted,
        "px",
        "largest distance over the picture from the true bilinear map, told by four pairs",
    );
    account.sentence = format!(
        "Phase correlation finds a shift by whole pixels with an error of {whole:.3} px and one by halves with {half:.3} px; \
         four control points give the bilinear map to {fitted:.4} px. Neither says which thing in a picture is the landmark."
    );
    account.picture(&grey(&plane.cropped(PART), 0.0, 255.0)?, "A part of frame 37")?;
    account
        .picture(&grey(&warped.cropped(PART), 0.0, 255.0)?, "The same registered by four control points")?;
    Ok(account)
}

/// How far the found shift is off.
fn shift_error(plane: &Plane, dx: f32, dy: f32, account: &mut Account) -> Result<f64, ExperimentError> {
    let size = SizePx { width: PART.width, height: PART.height };
    let first = plane.cropped(PART);
    let second = Plane::from_fn(size, |x, y| {
        let at = PointPx::new((PART.x + x) as f32 + 0.5 - dx, (PART.y + y) as f32 + 0.5 - dy);
        Interpolation::Bicubic.sample(plane, at, Border::Nearest)
    });
    let mut correlator = PhaseCorrelator::new(size, Taper::Hann)?;
    let found = correlator.shift(&first, &second)?;
    if dx.fract() == 0.0 {
        let peak = around_zero(correlator.surface());
        account.picture(
            &heat(&peak)?,
            "Phase correlation: one peak at the shift (9, −5); no shift is the middle",
        )?;
    }
    Ok(f64::from((found.dx_px - dx).hypot(found.dy_px - dy)))
}

/// The shifts of up to so many pixels in every direction.
const SHOWN_PX: u32 = 20;

/// The middle of the surface, whose shifts count around its edges.
fn around_zero(surface: &Plane) -> Plane {
    let SizePx { width, height } = surface.size();
    let side = 2 * SHOWN_PX + 1;
    Plane::from_fn(SizePx { width: side, height: side }, |x, y| {
        surface.get((x + width - SHOWN_PX) % width, (y + height - SHOWN_PX) % height)
    })
}

/// The largest error of the map told by four pairs, and the picture that it makes.
fn control_points(plane: &Plane) -> Result<(f64, Plane), ExperimentError> {
    let map = BilinearMap { x: [0.92, 0.06, 1e-4, 12.0], y: [-0.05, 0.95, 5e-5, 8.0] };
    let SizePx { width, height } = plane.size();
    let corner = |x: u32, y: u32| PointPx::new(x as f32, y as f32);
    let from =
        [corner(40, 40), corner(width - 60, 30), corner(50, height - 40), corner(width - 30, height - 50)];
    let pairs = from.map(|from| ControlPoint { from, to: map.apply(from) });
    let fitted = BilinearMap::fit(&pairs)?;
    let places = (0..height).step_by(20).flat_map(|y| (0..width).step_by(20).map(move |x| corner(x, y)));
    let furthest =
        places.map(|at| f64::from(map.apply(at).distance_px(fitted.apply(at)))).fold(0.0, f64::max);
    Ok((furthest, fitted.warp(plane, plane.size(), Interpolation::Bilinear, Border::Nearest)))
}
