//! Normalised cross correlation with the first picture of the object (thesis 2.7.4).

use vision::methods::Ncc;
use vision::methods::ncc::{Colours, NccOptions};
use vision::{Frame, RectPx};

use super::method::Method;
use crate::score::Claim;
use crate::thumbnail::part;

/// Below this coefficient nothing is claimed: half of the variance is explained.
const LEAST_SCORE: f32 = 0.7;
/// Sizes at which the template is looked for: steps of a quarter, from a bit smaller to over three times as large.
const SCALES: [f32; 8] = [0.8, 1.0, 1.25, 1.55, 1.95, 2.45, 3.05, 3.8];

/// A template and the way to look for it.
pub(super) struct Correlation {
    options: NccOptions,
    template: Option<(Ncc, f32)>,
}

impl Correlation {
    pub(super) fn new(method: Method) -> Self {
        let colours = if method == Method::NccGrey { Colours::Grey } else { Colours::Rgb };
        let scales = if method == Method::NccScales { SCALES.to_vec() } else { vec![1.0] };
        Self { options: NccOptions { colours, scales }, template: None }
    }

    /// A flat template stays without one: it correlates with nothing.
    pub(super) fn show(&mut self, frame: &Frame, object: RectPx, claim: Claim) {
        let template = Ncc::new(&part(frame, object), &self.options).ok();
        self.template = template.map(|ncc| (ncc, claim.area_px2));
    }

    pub(super) fn look(&mut self, frame: &Frame) -> Option<Claim> {
        let (ncc, area_px2) = self.template.as_mut()?;
        let found = ncc.search(frame, None).filter(|found| found.score >= LEAST_SCORE)?;
        Some(Claim { centre: found.at, area_px2: *area_px2 * found.scale * found.scale, score: found.score })
    }
}
