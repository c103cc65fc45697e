//! Which topics of a recording belong together.

use std::path::Path;

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

/// The topics that descriptors were recorded on: `/{vehicle}/landmark`.
pub(super) fn landmarks<'a>(topics: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    topics.filter(|topic| matches!(topic.split('/').collect::<Vec<_>>()[..], ["", _, "landmark"])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_known_by_their_pictures() {
        let topics = ["/car/camera/front/image", "/car/camera/front/registration", "/car/status", "/image"];
        let found = cameras(topics.into_iter());
        assert_eq!(found.len(), 1);
        assert_eq!(
            landmarks(["/lead/landmark", "/landmark", "/a/camera/landmark"].into_iter()),
            ["/lead/landmark"]
        );
        assert_eq!((found[0].camera.as_str(), found[0].registration.as_str()), ("front", topics[1]));
    }
}
