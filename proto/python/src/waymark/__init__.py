"""Waymark's messages, key expressions and recordings.

``waymark.live``       landmarks and registrations as they arrive over Zenoh
``waymark.recording``  the same from an MCAP recording
``waymark.keys``       the key expressions
``waymark.attachment`` sequence number, source time and origin of a sample
``waymark.v1``         the generated messages; units and frames stand in the .proto files

Coordinates are frame pixels: origin at the top-left corner, x right, y down, centre of the first pixel (0.5, 0.5).
"""

from waymark.attachment import Attachment
from waymark.landmark_set import LandmarkView, Retired
from waymark.live import landmarks, registrations

__all__ = ["Attachment", "LandmarkView", "Retired", "landmarks", "registrations"]
