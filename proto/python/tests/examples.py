"""Messages as a leader and a follower would send them."""

from waymark.digest import landmark_digest, set_digest
from waymark.v1 import ColorStats, Landmark, LandmarkManifest, Registration, ShapeClass


def make_landmark(landmark_id: str, *, revision: int = 1, epoch: int = 1, red_mean: float = 120.0) -> Landmark:
    landmark = Landmark(
        id=landmark_id,
        revision=revision,
        epoch=epoch,
        window_width_px=12,
        window_height_px=12,
        shades=[ColorStats(mean=[red_mean, 40.5, 38.25], variance=[20.0, 10.0, 12.5])],
        tolerance=ColorStats(mean=[15.0] * 3, variance=[50.0] * 3),
        shape=ShapeClass.SHAPE_CLASS_BLOCK,
    )
    landmark.digest = landmark_digest(landmark)
    return landmark


def make_manifest(landmarks: list[Landmark], *, version: int, epoch: int = 1) -> LandmarkManifest:
    return LandmarkManifest(epoch=epoch, version=version, count=len(landmarks), digest=set_digest(landmarks))


def make_registration(sequence: int, landmark: str = "red") -> Registration:
    registration = Registration(camera="front", sequence=sequence, captured_at_ns=sequence * 1_000_000)
    result = registration.landmarks.add(landmark=landmark)
    result.sighting.centroid.x_px = 441.94
    result.sighting.centroid.y_px = 322.30
    result.sighting.mask_area_2x = 203.5
    result.sighting.score = 0.9
    return registration
