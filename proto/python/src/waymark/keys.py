"""Every key expression, as in ``proto/src/keys.rs``. Any part may be ``*`` to match all."""

import re

ROOT = "waymark/v1"

_ID = re.compile(r"[a-z0-9][a-z0-9_-]{0,62}")


def vehicle(fleet: str, name: str) -> str:
    """The root of all keys of one vehicle. Raises ``ValueError`` for a name that is no id."""
    return f"{ROOT}/{_chunk('fleet', fleet)}/{_chunk('vehicle', name)}"


def landmark(fleet: str, vehicle_name: str, landmark_id: str) -> str:
    """One landmark's descriptor, ``waymark.v1.Landmark``."""
    return f"{vehicle(fleet, vehicle_name)}/landmark/{_chunk('landmark', landmark_id)}"


def landmark_set(fleet: str, vehicle_name: str) -> str:
    """What to query for all descriptors of a leader."""
    return f"{vehicle(fleet, vehicle_name)}/landmark/**"


def manifest(fleet: str, vehicle_name: str) -> str:
    """What the whole set is, ``waymark.v1.LandmarkManifest``."""
    return f"{vehicle(fleet, vehicle_name)}/manifest"


def image(fleet: str, vehicle_name: str, camera: str) -> str:
    """Pictures: ``foxglove.CompressedImage``, ``RawImage`` or ``CompressedVideo``; the encoding's schema says which."""
    return _camera(fleet, vehicle_name, camera, "image")


def calibration(fleet: str, vehicle_name: str, camera: str) -> str:
    """How a camera sees, ``foxglove.CameraCalibration``."""
    return _camera(fleet, vehicle_name, camera, "calibration")


def registration(fleet: str, vehicle_name: str, camera: str) -> str:
    """What each frame said about every landmark, ``waymark.v1.Registration``."""
    return _camera(fleet, vehicle_name, camera, "registration")


def annotations(fleet: str, vehicle_name: str, camera: str) -> str:
    """The same as a drawing, ``foxglove.ImageAnnotations``."""
    return _camera(fleet, vehicle_name, camera, "annotations")


def truth(fleet: str, vehicle_name: str, camera: str) -> str:
    """Where a simulator really put everything, ``waymark.v1.Truth``."""
    return _camera(fleet, vehicle_name, camera, "truth")


def status(fleet: str, vehicle_name: str) -> str:
    """What a vehicle says of itself once a second, ``waymark.v1.VehicleStatus``."""
    return f"{vehicle(fleet, vehicle_name)}/status"


def _camera(fleet: str, vehicle_name: str, camera: str, tail: str) -> str:
    return f"{vehicle(fleet, vehicle_name)}/camera/{_chunk('camera', camera)}/{tail}"


def _chunk(what: str, value: str) -> str:
    if value != "*" and not _ID.fullmatch(value):
        raise ValueError(f"{what} '{value}' is no id: allowed are [a-z0-9][a-z0-9_-]{{0,62}}, or * for all")
    return value
