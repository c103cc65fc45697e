"""A client that comes late: receives the landmark set, then registrations, and finds every field of theirs.

    python late_client.py ENDPOINT FLEET

Runs against a convoy of real services; prints what it decoded. Exit code 1 when something is missing.
"""

import sys
from collections.abc import Iterator
from itertools import islice
from typing import Any

import zenoh
from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message
from google.protobuf.unknown_fields import UnknownFieldSet

import waymark
import waymark.keys
from waymark.digest import landmark_digest, set_digest
from waymark.v1 import Landmark, LandmarkManifest, Registration

PATIENCE_S = 60
"""Only a failure waits this long."""
MOST_FRAMES = 400
"""A rink has been driven around by then."""

MAY_BE_ABSENT = {
    # Reasons of misses, and what only one kind of scene, landmark or calibration brings.
    "landmarks.miss.best.at.x_px", "landmarks.miss.best.at.y_px", "landmarks.miss.best.observed.mean",
    "landmarks.miss.best.observed.variance", "landmarks.miss.best.worst", "landmarks.miss.best.excess",
    "landmarks.miss.shape_score", "landmarks.miss.innovation_px", "landmarks.miss.visible", "landmarks.miss.reason",
    "landmarks.bearing_rad", "landmarks.range_m", "landmarks.instance", "landmarks.adaptation.full_frame",
    "landmarks.sighting.shape_score", "landmarks.adaptation.noise_variance",
    # 0 as long as the predictor takes the axes as independent, and protobuf does not send a 0.
    "landmarks.prediction.covariance_xy_px2",
}  # fmt: skip


def leaves(descriptor: Any, prefix: str = "") -> Iterator[str]:
    """The path of every plain field below a message; two implementations of descriptors share no type."""
    for field in descriptor.fields:
        if field.type == FieldDescriptor.TYPE_MESSAGE:
            yield from leaves(field.message_type, f"{prefix}{field.name}.")
        else:
            yield prefix + field.name


def found(message: Message, prefix: str = "") -> Iterator[str]:
    """The path of every plain field that this message holds, and of every one that its descriptor does not know."""
    unknown = UnknownFieldSet(message)
    for at in range(len(unknown)):
        yield f"{prefix}?{unknown[at].field_number}"
    for field, value in message.ListFields():
        if field.type != FieldDescriptor.TYPE_MESSAGE:
            yield prefix + field.name
            continue
        for below in [value] if isinstance(value, Message) else value:
            yield from found(below, f"{prefix}{field.name}.")


def check_landmarks(session: zenoh.Session, fleet: str) -> set[bytes]:
    """The whole set arrives at once, and its digests are those that this package computes."""
    manifest_key = waymark.keys.manifest(fleet, "leader")
    (manifest,) = [
        LandmarkManifest.FromString(reply.ok.payload.to_bytes()) for reply in session.get(manifest_key) if reply.ok
    ]
    with waymark.landmarks(session, fleet=fleet, vehicle="leader", timeout_s=PATIENCE_S) as stream:
        first = [change for change in islice(stream, manifest.count) if isinstance(change, Landmark)]
    assert set_digest(first) == manifest.digest, first
    for landmark in first:
        assert landmark_digest(landmark) == landmark.digest, landmark.id
        print(f"landmark {landmark.id}: revision {landmark.revision}, {len(landmark.shades)} shades")
    return {landmark.digest for landmark in first}


def check_registrations(session: zenoh.Session, fleet: str, digests: set[bytes]) -> None:
    """Registrations go on arriving; between them they hold every field that there is."""
    seen: set[str] = set()
    wanted = set(leaves(Registration.DESCRIPTOR)) - MAY_BE_ABSENT
    count = 0
    with waymark.registrations(session, fleet=fleet, timeout_s=PATIENCE_S) as stream:
        for received in islice(stream, MOST_FRAMES):
            count += 1
            assert received.attachment is not None
            assert {result.digest for result in received.message.landmarks} <= digests
            seen.update(found(received.message))
            if wanted <= seen and count >= 20:
                break
        missed = stream.missed
    assert wanted <= seen, f"never seen in {count} frames: {sorted(wanted - seen)}"
    assert not any("?" in path for path in seen), f"fields that the package does not know: {sorted(seen)}"
    print(f"registrations: {count} frames, {missed} missed, {len(seen)} different fields decoded")


def main() -> None:
    endpoint, fleet = sys.argv[1:]
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{endpoint}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as session:
        check_registrations(session, fleet, check_landmarks(session, fleet))


if __name__ == "__main__":
    main()
