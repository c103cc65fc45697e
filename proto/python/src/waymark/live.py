"""Landmarks and registrations as they arrive.

    import zenoh, waymark

    with zenoh.open(zenoh.Config()) as session:
        for received in waymark.registrations(session, fleet="convoy"):
            print(received.message.camera, received.message.sequence)

Samples wait in a bounded queue; when the reader is slower than the vehicles the newest are refused and counted in
``Stream.refused``, so that nobody ever waits for this program.
"""

import queue
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import Generic, Protocol, Self, TypeVar

import zenoh

from waymark import keys
from waymark.attachment import Attachment, GapCounter
from waymark.landmark_set import Change, LandmarkView
from waymark.v1.landmark_pb2 import Landmark, LandmarkManifest
from waymark.v1.registration_pb2 import Registration

QUERY_TIMEOUT_S = 2.0

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Received(Generic[T]):
    """A message with what travelled beside it."""

    key: str
    message: T
    attachment: Attachment | None
    """Absent when the sender is no program of ours."""


class _Closed:
    """Ends the stream it is put into."""


class _Undeclare(Protocol):
    def undeclare(self) -> None: ...


class Stream(Generic[T]):
    """Samples of one or several subscriptions, in the order of their arrival. Iterate it; close it, or use ``with``."""

    def __init__(self, capacity: int, timeout_s: float | None) -> None:
        self._waiting: queue.Queue[zenoh.Sample | _Closed] = queue.Queue(capacity)
        self._timeout_s = timeout_s
        self._subscriptions: list[_Undeclare] = []
        self._gaps = GapCounter()
        self.refused = 0
        """Samples that arrived while the queue was full."""

    @property
    def missed(self) -> int:
        """Samples that were sent and did not arrive, by the gaps in their sequence."""
        return self._gaps.missed

    def subscribe(self, session: zenoh.Session, key: str) -> None:
        """Adds what is published below ``key``."""
        self._subscriptions.append(session.declare_subscriber(key, self.offer))

    def offer(self, sample: zenoh.Sample) -> None:
        """Takes a sample, or refuses it when the queue is full; never waits."""
        try:
            self._waiting.put_nowait(sample)
        except queue.Full:
            self.refused += 1

    def samples(self) -> Iterator[tuple[zenoh.Sample, Attachment | None]]:
        """Waits for each sample. Raises ``TimeoutError`` after ``timeout_s`` without one."""
        while True:
            try:
                sample = self._waiting.get(timeout=self._timeout_s)
            except queue.Empty:
                raise TimeoutError(f"no sample for {self._timeout_s} s") from None
            if isinstance(sample, _Closed):
                return
            attachment = _attachment(sample)
            self._gaps.observe(attachment)
            yield sample, attachment

    def close(self) -> None:
        """Ends the subscriptions and the iteration."""
        for subscription in self._subscriptions:
            subscription.undeclare()
        self._subscriptions.clear()
        while True:
            try:
                self._waiting.put_nowait(_Closed())
                return
            except queue.Full:
                self._waiting.get_nowait()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Registrations(Stream[Registration]):
    """Registrations as they are published."""

    def __iter__(self) -> Iterator[Received[Registration]]:
        for sample, attachment in self.samples():
            yield Received(str(sample.key_expr), Registration.FromString(sample.payload.to_bytes()), attachment)


class Landmarks(Stream[Change]):
    """The landmark set of one leader: first all of it, then each change."""

    def __init__(self, capacity: int, timeout_s: float | None, fetch: Callable[[], list[Landmark]]) -> None:
        super().__init__(capacity, timeout_s)
        self._fetch = fetch
        self.view = LandmarkView()
        """The set as it stands after the change that was yielded last."""

    def __iter__(self) -> Iterator[Change]:
        yield from self.view.on_whole_set(self._fetch())
        for sample, _ in self.samples():
            yield from self._on_sample(sample)

    def _on_sample(self, sample: zenoh.Sample) -> list[Change]:
        payload = sample.payload.to_bytes()
        if "/landmark/" in str(sample.key_expr):
            return self.view.on_landmark(Landmark.FromString(payload))
        self.view.on_manifest(LandmarkManifest.FromString(payload))
        return [] if self.view.complete else self.view.on_whole_set(self._fetch())


def registrations(
    session: zenoh.Session,
    *,
    fleet: str,
    vehicle: str = "*",
    camera: str = "*",
    capacity: int = 256,
    timeout_s: float | None = None,
) -> Registrations:
    """What each frame said about every landmark, one message a frame."""
    stream = Registrations(capacity, timeout_s)
    stream.subscribe(session, keys.registration(fleet, vehicle, camera))
    return stream


def landmarks(
    session: zenoh.Session,
    *,
    fleet: str,
    vehicle: str,
    capacity: int = 256,
    timeout_s: float | None = None,
) -> Landmarks:
    """The landmarks of the leader ``vehicle``, however late this program starts; then every change and retirement."""
    stream = Landmarks(capacity, timeout_s, lambda: fetch_landmarks(session, fleet=fleet, vehicle=vehicle))
    stream.subscribe(session, keys.landmark(fleet, vehicle, "*"))
    stream.subscribe(session, keys.manifest(fleet, vehicle))
    return stream


def fetch_landmarks(
    session: zenoh.Session, *, fleet: str, vehicle: str, timeout_s: float = QUERY_TIMEOUT_S
) -> list[Landmark]:
    """All replies of the leader, and of any store that answers for it; one landmark may come more than once."""
    replies = session.get(
        keys.landmark_set(fleet, vehicle),
        consolidation=zenoh.ConsolidationMode.NONE,
        congestion_control=zenoh.CongestionControl.DROP,
        timeout=timeout_s,
    )
    return [Landmark.FromString(reply.ok.payload.to_bytes()) for reply in replies if reply.ok is not None]


def _attachment(sample: zenoh.Sample) -> Attachment | None:
    if sample.attachment is None:
        return None
    try:
        return Attachment.from_bytes(sample.attachment.to_bytes())
    except ValueError:
        return None
