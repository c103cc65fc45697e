//! Section 2.4: nearest-neighbour, bilinear and bicubic interpolation; and whether the doubled resolution of step 4 helps.

use simulator::SceneKind;
use vision::SizePx;
use vision::methods::{Intensity, Interpolation, Plane};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::lab::TEMPLATE_FRAME;
use crate::experiments::picture::grey;
use crate::experiments::{ExperimentError, Lab};
use crate::stage_times::thread_cpu_ns;
use crate::thumbnail::part;

const METHODS: [(Interpolation, &str); 3] = [
    (Interpolation::Nearest, "nearest"),
    (Interpolation::Bilinear, "bilinear"),
    (Interpolation::Bicubic, "bicubic"),
];

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let plane = Plane::of(&lab.rink_frame()?, Intensity::Luma);
    let half = halved(&plane);
    let mut account = Account::default();
    let mut told = Vec::new();
    for (method, name) in METHODS {
        let started_ns = thread_cpu_ns();
        let again = method.resized(&half, plane.size());
        let cost_ms = (thread_cpu_ns() - started_ns) as f64 * 1e-6;
        let squares: f64 =
            again.values().iter().zip(plane.values()).map(|(a, b)| f64::from(a - b).powi(2)).sum();
        let rms = (squares / plane.values().len() as f64).sqrt();
        account.compare(
            format!("{name} error"),
            Thesis::Silent,
            rms,
            "levels RMS",
            "frame 37 of the rink, halved and doubled again",
        );
        let said = match method {
            Interpolation::Nearest => Thesis::Words("easy to implement"),
            Interpolation::Bilinear => Thesis::Silent,
            Interpolation::Bicubic => Thesis::Words("most expensive"),
        };
        account.compare(format!("{name} cost"), said, cost_ms, "ms CPU", "640×480 pixels made");
        told.push(format!("{name} {rms:.2} levels in {cost_ms:.1} ms"));
    }
    account.sentence =
        format!("Halved and doubled again, the rink's frame is missed by {}.", told.join(", "));
    let around = lab.drive(SceneKind::Rink)?.region(TEMPLATE_FRAME, "red", 2.0)?;
    let near = Plane::of(&part(&lab.rink_frame()?, around), Intensity::Luma);
    let size = SizePx { width: 6 * near.width(), height: 6 * near.height() };
    for (method, name) in METHODS {
        account.picture(
            &grey(&method.resized(&near, size), 0.0, 255.0)?,
            format!("The red block six times as large, {name}"),
        )?;
    }
    Ok(account)
}

/// Each pixel the mean of four.
fn halved(plane: &Plane) -> Plane {
    let size = SizePx { width: plane.width() / 2, height: plane.height() / 2 };
    Plane::from_fn(size, |x, y| {
        let at = |dx: u32, dy: u32| plane.get(2 * x + dx, 2 * y + dy);
        (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4.0
    })
}
