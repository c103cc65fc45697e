"""Messages of a Waymark recording (MCAP), typed.

Every schema in a recording is complete, so programs that know nothing of Waymark read it as well; these readers only
add the types.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from google.protobuf.message import Message
from mcap.reader import make_reader

from waymark.v1.landmark_pb2 import Landmark
from waymark.v1.registration_pb2 import Registration
from waymark.v1.truth_pb2 import Truth

M = TypeVar("M", bound=Message)


@dataclass(frozen=True, slots=True)
class Recorded(Generic[M]):
    """A message with its place in the recording."""

    topic: str
    received_at_ns: int
    captured_at_ns: int
    sequence: int
    message: M


def messages(path: str | Path, kind: type[M]) -> Iterator[Recorded[M]]:
    """All messages of one type, in the order of their receipt."""
    schema_name = kind.DESCRIPTOR.full_name
    with open(path, "rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            if schema is not None and schema.name == schema_name:
                yield Recorded(
                    topic=channel.topic,
                    received_at_ns=message.log_time,
                    captured_at_ns=message.publish_time,
                    sequence=message.sequence,
                    message=kind.FromString(message.data),
                )


def registrations(path: str | Path) -> Iterator[Recorded[Registration]]:
    """What each frame said about every landmark when it was driven, not what was found later (`…/again`)."""
    return (entry for entry in messages(path, Registration) if not entry.topic.endswith("/again"))


def landmarks(path: str | Path) -> Iterator[Recorded[Landmark]]:
    """The descriptors: those in force at the start of the file, then each change."""
    return messages(path, Landmark)


def truth(path: str | Path) -> Iterator[Recorded[Truth]]:
    """Where the simulator really put everything; empty for a recording of real cameras."""
    return messages(path, Truth)
