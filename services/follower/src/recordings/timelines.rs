//! Timelines of the recordings that were looked at last, so that scrubbing does not read them again.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use recording::RecordingError;
use recording::timeline::Timeline;

use super::Found;

/// A timeline of an hour at 30 Hz has about 2 MB.
const MAX_KEPT: usize = 4;

#[derive(Debug, Default)]
pub(super) struct Timelines {
    /// By entity tag, the one used last in front.
    kept: Mutex<VecDeque<(String, Arc<Timeline>)>>,
}

impl Timelines {
    /// The timeline of a recording; waits for the disk.
    pub(super) fn of(&self, found: &Found) -> Result<Arc<Timeline>, RecordingError> {
        let key = format!("{} {}", found.name, found.tag);
        if let Some(timeline) = self.kept_as(&key) {
            return Ok(timeline);
        }
        let timeline = Arc::new(Timeline::read(&found.path)?);
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push_front((key, Arc::clone(&timeline)));
        kept.truncate(MAX_KEPT);
        Ok(timeline)
    }

    fn kept_as(&self, key: &str) -> Option<Arc<Timeline>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|(known, _)| known == key)?;
        let entry = kept.remove(at)?;
        let timeline = Arc::clone(&entry.1);
        kept.push_front(entry);
        Some(timeline)
    }
}

/// A camera's topics in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct CameraTopics {
    pub(super) camera: String,
    pub(super) image: String,
    pub(super) registration: String,
}

/// The cameras whose pictures a recording holds.
pub(super) fn cameras<'a>(topics: impl Iterator<Item = &'a str>) -> Vec<CameraTopics> {
    topics.filter_map(camera_of).collect()
}

/// `/{vehicle}/camera/{camera}/image`.
fn camera_of(topic: &str) -> Option<CameraTopics> {
    let place = topic.strip_suffix("/image")?;
    let camera = Path::new(place).file_name()?.to_str()?.to_owned();
    place.ends_with(&format!("/camera/{camera}")).then(|| CameraTopics {
        camera,
        image: topic.to_owned(),
        registration: format!("{place}/registration"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_known_by_their_pictures() {
        let topics = ["/car/camera/front/image", "/car/camera/front/registration", "/car/status", "/image"];
        let found = cameras(topics.into_iter());
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].camera.as_str(), found[0].registration.as_str()), ("front", topics[1]));
    }
}
