//! All that the outcome of later frames depends on: plain data.

use super::FrameStamp;
use crate::adaptive::{Candidate, Light};
use crate::landmark::{Digest, Landmark};
use crate::predict::{Fix, Predictor};

/// How fast gain and score are followed.
const FOLLOW_RATE: f32 = 0.2;
/// and haze, which changes when a camera sets its contrast anew.
const HAZE_RATE: f32 = 0.4;
/// No more haze than this is believed, levels.
const MOST_HAZE: f32 = 60.0;

/// The state of a [`Follow`](super::Follow) between two frames. Cloned from another one into an older one it asks for no
/// memory but for what is new.
#[derive(Debug, Default, PartialEq)]
pub struct FollowState {
    /// The last frame seen.
    pub last: Option<FrameStamp>,
    /// Noise variance of the camera, levels², R, G, B.
    pub noise_variance: [f32; 3],
    /// The landmark whose turn comes first, an index into the set.
    pub turn: usize,
    /// One entry for each landmark, in the order of the set.
    pub landmarks: Vec<LandmarkState>,
}

/// What is known of one landmark's objects.
#[derive(Debug, Default, PartialEq)]
pub struct LandmarkState {
    /// The landmark's id.
    pub id: String,
    /// The digest of its descriptor.
    pub digest: Digest,
    /// The number that the next new object gets.
    pub next_instance: u32,
    /// Frames since the whole frame was last searched for it.
    pub frames_since_search: u32,
    /// Its objects, by instance number.
    pub tracks: Vec<Track>,
}

/// One object that was seen at least once.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Its instance number.
    pub instance: u32,
    /// Its motion.
    pub predictor: Predictor,
    /// Brightness over the descriptor's, followed.
    pub gain: f32,
    /// White that haze, gloss or the camera adds to the descriptor's colours, levels, followed.
    pub haze: f32,
    /// Score, followed.
    pub score: f32,
    /// Its area when it was last seen whole, px².
    pub whole_area_px2: f32,
    /// Frames in which it was seen.
    pub sightings: u32,
    /// Frames since it was last seen.
    pub misses: u32,
}

impl Clone for FollowState {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    fn clone_from(&mut self, source: &Self) {
        let Self { last, noise_variance, turn, landmarks } = source;
        (self.last, self.noise_variance, self.turn) = (*last, *noise_variance, *turn);
        self.landmarks.clone_from(landmarks);
    }
}

impl Clone for LandmarkState {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    fn clone_from(&mut self, source: &Self) {
        let Self { id, digest, next_instance, frames_since_search, tracks } = source;
        self.id.clone_from(id);
        (self.digest, self.next_instance) = (*digest, *next_instance);
        self.frames_since_search = *frames_since_search;
        self.tracks.clone_from(tracks);
    }
}

/// What a sighting says of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// It goes on.
    Continued,
    /// The object was lost and is not where its motion would have led: nothing is known of it any more.
    Anew,
}

impl LandmarkState {
    /// Of a landmark that was never seen.
    #[must_use]
    pub fn new(landmark: &Landmark) -> Self {
        Self { id: landmark.id.clone(), digest: landmark.digest, ..Self::default() }
    }

    /// The light in which the whole frame is searched: that on the object known longest.
    pub(super) fn light(&self) -> Light {
        self.tracks.first().map_or(Light::AS_LEARNED, Track::light)
    }

    /// A new object, seen for the first time.
    pub(super) fn begin(&mut self, predictor: Predictor, light: Light, score: f32) -> &Track {
        let instance = self.next_instance;
        self.next_instance += 1;
        let whole_area_px2 = predictor.fixes.first().map_or(0.0, |fix| fix.area_px2);
        let (sightings, misses) = (1, 0);
        let (gain, haze) = (light.gain, bounded(light.haze));
        self.tracks.push(Track { instance, predictor, gain, haze, score, whole_area_px2, sightings, misses });
        &self.tracks[self.tracks.len() - 1]
    }
}

fn bounded(haze: f32) -> f32 {
    haze.clamp(-MOST_HAZE, MOST_HAZE)
}

impl Track {
    /// What is known of the light on it.
    pub(super) fn light(&self) -> Light {
        Light { gain: self.gain, haze: self.haze }
    }

    /// Takes a sighting into account.
    pub(super) fn follow(&mut self, found: &Candidate<'_>, fix: Fix, motion: Motion) {
        self.misses = 0;
        self.sightings = self.sightings.saturating_add(1);
        // What the picture's border or something else cuts tells little of how the whole object looks.
        if !found.cut {
            self.gain += FOLLOW_RATE * (found.light.gain - self.gain);
            self.haze = bounded(self.haze + HAZE_RATE * (found.light.haze - self.haze));
            self.score += FOLLOW_RATE * (found.score - self.score);
        }
        if !found.cut || found.area_px2 > self.whole_area_px2 {
            self.whole_area_px2 = found.area_px2;
        }
        match motion {
            Motion::Continued => self.predictor.update(fix),
            Motion::Anew => self.predictor = Predictor::new(self.predictor.method, fix),
        }
    }
}
