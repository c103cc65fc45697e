//! Pictures that somebody learns from: kept as they were, so that the box drawn and the landmark learned belong to the
//! same pixels however long it takes to draw it.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use vision::explain::explain;
use vision::learn::{LearnError, LearnOptions, learn};
use vision::separation::{Separation, separation};
use vision::{Frame, Landmark, Mode, RectPx, Sighting};

/// Pictures kept; the oldest gives way.
const MAX_KEPT: usize = 8;

/// A picture to learn from.
#[derive(Debug)]
pub(crate) struct Lesson {
    pub(crate) number: u64,
    pub(crate) camera: String,
    pub(crate) sequence: u64,
    pub(crate) captured_at_ns: i64,
    pub(crate) frame: Frame,
}

/// The pictures that are kept.
#[derive(Debug, Default)]
pub(crate) struct Lessons {
    kept: Mutex<(u64, VecDeque<Arc<Lesson>>)>,
}

/// What was learned, and how good it is.
#[derive(Debug)]
pub(crate) struct Learned {
    pub(crate) landmark: Landmark,
    pub(crate) separation: Separation,
    /// What registration finds in the same picture, as a follower would.
    pub(crate) seen: Option<Sighting>,
}

impl Lessons {
    /// Keeps a picture.
    pub(crate) fn keep(
        &self,
        camera: String,
        sequence: u64,
        captured_at_ns: i64,
        frame: Frame,
    ) -> Arc<Lesson> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.0 += 1;
        let lesson = Arc::new(Lesson { number: kept.0, camera, sequence, captured_at_ns, frame });
        kept.1.push_back(Arc::clone(&lesson));
        if kept.1.len() > MAX_KEPT {
            kept.1.pop_front();
        }
        lesson
    }

    /// A picture that is still kept.
    pub(crate) fn get(&self, number: u64) -> Option<Arc<Lesson>> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.1.iter().find(|lesson| lesson.number == number).map(Arc::clone)
    }
}

impl Lesson {
    /// The landmark of the object in `region`.
    pub(crate) fn landmark(&self, region: RectPx, options: &LearnOptions) -> Result<Landmark, LearnError> {
        learn(&[(&self.frame, region)], options)
    }

    /// The same, with how well it does.
    pub(crate) fn learn(&self, region: RectPx, options: &LearnOptions) -> Result<Learned, LearnError> {
        let landmark = self.landmark(region, options)?;
        let separation = separation(&self.frame, &landmark, region);
        let seen = explain(&self.frame, &landmark, Mode::Adaptive).outcome.result.ok();
        Ok(Learned { landmark, separation, seen })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_pictures_are_kept_under_numbers_of_their_own() {
        let lessons = Lessons::default();
        let picture = || Frame::from_rgb(1, 1, vec![0; 3]).unwrap();
        let numbers: Vec<u64> =
            (0..10).map(|sequence| lessons.keep("front".into(), sequence, 0, picture()).number).collect();
        assert_eq!(numbers, (1..=10).collect::<Vec<_>>());
        assert!(lessons.get(2).is_none());
        assert_eq!(lessons.get(3).unwrap().sequence, 2);
        assert!(lessons.get(11).is_none());
    }

    #[test]
    fn a_plain_object_on_another_ground_is_learned_found_and_stands_out() {
        let is_object = |x: usize, y: usize| (40..64).contains(&x) && (30..54).contains(&y);
        let noise = |x: usize, y: usize| ((x * 7 + y * 13) % 5) as u8;
        let pixel = |x, y| {
            let grain = noise(x, y);
            if is_object(x, y) { [190 + grain, 30 + grain, 30 + grain] } else { [90 + grain, 120, 140] }
        };
        let rgb = (0..96).flat_map(|y| (0..128).flat_map(move |x| pixel(x, y))).collect();
        let lesson = Lessons::default().keep("front".into(), 1, 0, Frame::from_rgb(128, 96, rgb).unwrap());
        let region = RectPx { x: 40, y: 30, width: 24, height: 24 };
        let learned = lesson.learn(region, &LearnOptions::default()).unwrap();
        assert!(learned.separation.excess() > 2.0, "{:?}", learned.separation);
        let seen = learned.seen.unwrap();
        assert!((seen.centroid.x - 52.0).abs() < 2.0 && (seen.centroid.y - 42.0).abs() < 2.0, "{seen:?}");
    }
}
