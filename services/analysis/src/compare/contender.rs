//! A method at work.

use vision::{Frame, FrameStamp, Landmark, RectPx};

use super::blob::ColourBlob;
use super::carried::{ByFlow, ByPhase};
use super::correlation::Correlation;
use super::lone_hough::LoneHough;
use super::method::Method;
use super::statistical::Statistical;
use crate::score::Claim;

/// A method with its memory.
pub(super) enum Contender {
    Statistical(Box<Statistical>),
    Correlation(Correlation),
    Phase(ByPhase),
    Flow(ByFlow),
    Blob(Box<ColourBlob>),
    Hough(LoneHough),
}

impl Contender {
    pub(super) fn new(method: Method, landmark: &Landmark) -> Self {
        match method {
            Method::Faithful | Method::Adaptive => {
                Self::Statistical(Box::new(Statistical::new(method, landmark)))
            }
            Method::NccGrey | Method::NccColour | Method::NccScales => {
                Self::Correlation(Correlation::new(method))
            }
            Method::PhaseCorrelation => Self::Phase(ByPhase::default()),
            Method::OpticalFlow => Self::Flow(ByFlow::default()),
            Method::ColourBlob => Self::Blob(Box::new(ColourBlob::new(landmark))),
            Method::HoughAlone => Self::Hough(LoneHough),
        }
    }

    /// Shows the object: `object` is its box in `frame`, `claim` what was measured there.
    pub(super) fn show(&mut self, frame: &Frame, object: RectPx, claim: Claim) {
        match self {
            Self::Correlation(correlation) => correlation.show(frame, object, claim),
            Self::Phase(phase) => phase.show(frame, claim),
            Self::Flow(flow) => flow.show(frame, claim),
            Self::Statistical(_) | Self::Blob(_) | Self::Hough(_) => {}
        }
    }

    /// Where the object is, if anywhere.
    pub(super) fn look(&mut self, frame: &Frame, stamp: FrameStamp) -> Option<Claim> {
        match self {
            Self::Statistical(statistical) => statistical.look(frame, stamp),
            Self::Correlation(correlation) => correlation.look(frame),
            Self::Phase(phase) => phase.look(frame),
            Self::Flow(flow) => flow.look(frame),
            Self::Blob(blob) => blob.look(frame),
            Self::Hough(hough) => hough.look(frame),
        }
    }
}
