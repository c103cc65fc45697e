"""What travels beside a payload: the 33-byte attachment of rmw_zenoh."""

import struct
from dataclasses import dataclass

_LAYOUT = struct.Struct("<qqB16s")
_GID_LENGTH = 16


@dataclass(frozen=True, slots=True)
class Attachment:
    """Number, time and origin of a sample."""

    sequence: int
    """Rises by one with every sample of this publisher."""
    source_time_ns: int
    """When the content came to be (for a picture: its capture), ns since the Unix epoch."""
    gid: bytes
    """16 bytes that name the publisher for as long as it lives."""

    def to_bytes(self) -> bytes:
        """The wire's form."""
        return _LAYOUT.pack(self.sequence, self.source_time_ns, _GID_LENGTH, self.gid)

    @classmethod
    def from_bytes(cls, data: bytes) -> "Attachment":
        """Reads the wire's form. Raises ``ValueError`` for bytes of another layout."""
        if len(data) != _LAYOUT.size or data[16] != _GID_LENGTH:
            raise ValueError(f"an attachment has {_LAYOUT.size} bytes with 0x10 as the 17th; these are {len(data)}")
        sequence, source_time_ns, _, gid = _LAYOUT.unpack(data)
        return cls(sequence, source_time_ns, gid)


class GapCounter:
    """Counts samples that were sent and never arrived, by the gaps in their publisher's sequence."""

    def __init__(self) -> None:
        self._last: dict[bytes, int] = {}
        self.missed = 0

    def observe(self, attachment: Attachment | None) -> None:
        """Takes note of a sample; one without attachment says nothing about gaps."""
        if attachment is None:
            return
        last = self._last.get(attachment.gid)
        if last is not None:
            self.missed += max(0, attachment.sequence - last - 1)
        self._last[attachment.gid] = max(attachment.sequence, last if last is not None else attachment.sequence)
