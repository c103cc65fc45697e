//! Methods that know motion and not objects: they carry the last place along, by phase correlation or optical flow. Their
//! area stays that of the first sighting.

use vision::methods::phase_correlation::Taper;
use vision::methods::{Flow, HornSchunck, Intensity, PhaseCorrelator, Plane};
use vision::{Frame, PointPx, RectPx, SizePx};

use super::box_around;
use crate::score::Claim;

/// Phase correlation looks at this many object sizes around the last place.
const PHASE_SIZES: f32 = 3.0;
/// A peak below this says that the two pictures have nothing in common.
const LEAST_PEAK: f32 = 0.03;
/// Optical flow is computed over this many object sizes; what is further away does not matter.
const FLOW_SIZES: f32 = 2.5;
/// No surroundings are smaller.
const LEAST_SIDE_PX: f32 = 32.0;

/// The last place, and the frame in which it was.
struct Carried {
    claim: Claim,
    last: Plane,
}

impl Carried {
    fn new(frame: &Frame, claim: Claim) -> Self {
        Self { claim, last: Plane::of(frame, Intensity::Luma) }
    }

    /// The surroundings of the last place.
    fn around(&self, sizes: f32) -> Option<RectPx> {
        let side = (sizes * self.claim.area_px2.sqrt()).max(LEAST_SIDE_PX);
        box_around(self.claim.centre, side, side, self.last.size())
    }

    /// Where it is now, having moved by so much; `None` outside the picture.
    fn moved(&mut self, now: Plane, dx: f32, dy: f32) -> Option<Claim> {
        let centre = PointPx::new(self.claim.centre.x + dx, self.claim.centre.y + dy);
        (self.last, self.claim.centre) = (now, centre);
        let SizePx { width, height } = self.last.size();
        let inside = (0.0..width as f32).contains(&centre.x) && (0.0..height as f32).contains(&centre.y);
        inside.then_some(self.claim)
    }
}

/// Carried by phase correlation.
#[derive(Default)]
pub(super) struct ByPhase {
    carried: Option<Carried>,
    correlator: Option<(SizePx, PhaseCorrelator)>,
}

impl ByPhase {
    pub(super) fn show(&mut self, frame: &Frame, claim: Claim) {
        self.carried = Some(Carried::new(frame, claim));
    }

    pub(super) fn look(&mut self, frame: &Frame) -> Option<Claim> {
        let carried = self.carried.as_mut()?;
        let now = Plane::of(frame, Intensity::Luma);
        let around = carried.around(PHASE_SIZES)?;
        let (before, after) = (carried.last.cropped(around), now.cropped(around));
        if self.correlator.as_ref().is_none_or(|(size, _)| *size != before.size()) {
            self.correlator =
                PhaseCorrelator::new(before.size(), Taper::Hann).ok().map(|new| (before.size(), new));
        }
        let (_, correlator) = self.correlator.as_mut()?;
        let shift = correlator.shift(&before, &after).ok().filter(|shift| shift.peak >= LEAST_PEAK);
        let (dx, dy) = shift.map_or((0.0, 0.0), |shift| (shift.dx_px, shift.dy_px));
        carried.moved(now, dx, dy)
    }
}

/// Carried by optical flow.
#[derive(Default)]
pub(super) struct ByFlow {
    carried: Option<Carried>,
    method: HornSchunck,
}

impl ByFlow {
    pub(super) fn show(&mut self, frame: &Frame, claim: Claim) {
        self.carried = Some(Carried::new(frame, claim));
    }

    pub(super) fn look(&mut self, frame: &Frame) -> Option<Claim> {
        let carried = self.carried.as_mut()?;
        let now = Plane::of(frame, Intensity::Luma);
        let around = carried.around(FLOW_SIZES)?;
        let flow: Option<Flow> = self.method.flow(&carried.last.cropped(around), &now.cropped(around)).ok();
        let side = carried.claim.area_px2.sqrt();
        let centre = carried.claim.centre;
        let within = PointPx::new(centre.x - around.x as f32, centre.y - around.y as f32);
        let object = box_around(within, side, side, SizePx { width: around.width, height: around.height });
        let (dx, dy) = flow.zip(object).and_then(|(flow, object)| flow.mean_px(object)).unwrap_or_default();
        carried.moved(now, dx, dy)
    }
}
