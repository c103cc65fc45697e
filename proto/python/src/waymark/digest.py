"""What a descriptor's and a set's digest cover; the layout stands in ``waymark/v1/landmark.proto``."""

import hashlib
import struct
from collections.abc import Iterable

from waymark.v1.landmark_pb2 import ColorStats, Landmark


def landmark_digest(landmark: Landmark) -> bytes:
    """SHA-256 over the content of one descriptor; its revision and epoch are not part of it."""
    name = landmark.id.encode()
    content = struct.pack("<I", len(name)) + name
    content += struct.pack("<II", landmark.window_width_px, landmark.window_height_px)
    content += struct.pack("<I", len(landmark.shades))
    for shade in landmark.shades:
        content += _statistics(shade)
    content += _statistics(landmark.tolerance)
    content += struct.pack("<I", landmark.shape)
    content += struct.pack("<Bf", 1, landmark.size_m) if landmark.HasField("size_m") else b"\0"
    return hashlib.sha256(content).digest()


def set_digest(landmarks: Iterable[Landmark]) -> bytes:
    """SHA-256 over the digests of all landmarks, in the order of their ids."""
    ordered = sorted(landmarks, key=lambda landmark: landmark.id)
    return hashlib.sha256(b"".join(landmark.digest for landmark in ordered)).digest()


def _statistics(stats: ColorStats) -> bytes:
    return struct.pack("<6f", *stats.mean, *stats.variance)
