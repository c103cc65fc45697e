//! Statistical-gradient registration in both modes.

use std::sync::Arc;

use vision::follow::{Follow, FollowOptions, Mode};
use vision::{Frame, FrameStamp, Landmark, LandmarkSet, NoProbe, SetVersion, Sighting};

use super::method::Method;
use crate::score::Claim;

/// The state machine that a follower runs, for one landmark.
pub(super) struct Statistical {
    follow: Follow,
}

impl Statistical {
    pub(super) fn new(method: Method, landmark: &Landmark) -> Self {
        let mode = if method == Method::Faithful { Mode::Faithful } else { Mode::Adaptive };
        let set = LandmarkSet { version: SetVersion::default(), landmarks: vec![Arc::new(landmark.clone())] };
        Self { follow: Follow::new(FollowOptions { mode, ..FollowOptions::default() }, set) }
    }

    pub(super) fn look(&mut self, frame: &Frame, stamp: FrameStamp) -> Option<Claim> {
        self.sighting(frame, stamp).as_ref().map(Claim::from)
    }

    /// The best instance.
    pub(super) fn sighting(&mut self, frame: &Frame, stamp: FrameStamp) -> Option<Sighting> {
        let outcome = self.follow.on_frame(frame, stamp, &mut NoProbe);
        let seen = outcome.landmarks.into_iter().filter_map(|landmark| landmark.result.ok());
        seen.reduce(|best, seen| if seen.score > best.score { seen } else { best })
    }
}
