"""Over real Zenoh sessions on the loopback: a leader and a follower played by this test, a late reader by the package."""

import socket
from collections.abc import Iterator
from itertools import islice
from threading import Event

import pytest
import zenoh
from examples import make_landmark, make_manifest, make_registration

import waymark
from waymark import Attachment, Retired, keys
from waymark.live import Registrations
from waymark.v1 import Landmark

FLEET, LEADER = "convoy", "leader"


def session_config(role: str, endpoint: str) -> zenoh.Config:
    config = zenoh.Config()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5(f"{role}/endpoints", f'["{endpoint}"]')
    if role == "connect":
        config.insert_json5("listen/endpoints", "[]")
    return config


@pytest.fixture
def sessions() -> Iterator[tuple[zenoh.Session, zenoh.Session]]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    with zenoh.open(session_config("listen", endpoint)) as vehicle:
        with zenoh.open(session_config("connect", endpoint)) as reader:
            yield vehicle, reader


def await_subscriber(publisher: zenoh.Publisher) -> None:
    matched = Event()
    publisher.declare_matching_listener(lambda status: matched.set() if status.matching else None)
    assert matched.wait(10), "the subscription never became known to the publisher"


class Leader:
    """Answers for its set and publishes the changes."""

    def __init__(self, session: zenoh.Session, landmarks: list[Landmark]) -> None:
        self.session = session
        self.landmarks = landmarks
        self.version = 1
        self._queryable = session.declare_queryable(keys.landmark_set(FLEET, LEADER), self._answer)

    def publish(self, landmark: Landmark) -> None:
        self.landmarks = [kept for kept in self.landmarks if kept.id != landmark.id] + [landmark]
        self.session.put(keys.landmark(FLEET, LEADER, landmark.id), landmark.SerializeToString())
        self._publish_manifest()

    def retire(self, landmark_id: str) -> None:
        self.landmarks = [kept for kept in self.landmarks if kept.id != landmark_id]
        self._publish_manifest()

    def _publish_manifest(self) -> None:
        self.version += 1
        manifest = make_manifest(self.landmarks, version=self.version)
        self.session.put(keys.manifest(FLEET, LEADER), manifest.SerializeToString())

    def _answer(self, query: zenoh.Query) -> None:
        for landmark in self.landmarks:
            query.reply(keys.landmark(FLEET, LEADER, landmark.id), landmark.SerializeToString())


def test_a_late_reader_has_the_set_and_then_every_change(sessions: tuple[zenoh.Session, zenoh.Session]) -> None:
    vehicle, reader = sessions
    leader = Leader(vehicle, [make_landmark("blue"), make_landmark("red")])
    with waymark.landmarks(reader, fleet=FLEET, vehicle=LEADER, timeout_s=10) as stream:
        changes = iter(stream)
        known = [next(changes), next(changes)]
        assert [change.id for change in known if isinstance(change, Landmark)] == ["blue", "red"]

        changed = make_landmark("red", revision=2, red_mean=99)
        leader.publish(changed)
        assert next(changes) == changed

        leader.retire("blue")
        assert next(changes) == Retired("blue")
        assert stream.view.complete
        assert set(stream.view.landmarks) == {"red"}


def test_registrations_arrive_with_their_attachment_and_gaps_are_counted(
    sessions: tuple[zenoh.Session, zenoh.Session],
) -> None:
    vehicle, reader = sessions
    with waymark.registrations(reader, fleet=FLEET, timeout_s=10) as stream:
        publisher = vehicle.declare_publisher(keys.registration(FLEET, "follower", "front"))
        await_subscriber(publisher)
        for sequence in (4, 5, 8):
            attachment = Attachment(sequence, sequence * 1_000_000, b"0123456789abcdef")
            publisher.put(make_registration(sequence).SerializeToString(), attachment=attachment.to_bytes())
        received = list(islice(stream, 3))
    assert [entry.message.sequence for entry in received] == [4, 5, 8]
    assert received[0].key == "waymark/v1/convoy/follower/camera/front/registration"
    assert received[0].attachment == Attachment(4, 4_000_000, b"0123456789abcdef")
    assert stream.missed == 2
    assert stream.refused == 0


def test_a_slow_reader_refuses_and_counts(sessions: tuple[zenoh.Session, zenoh.Session]) -> None:
    _, reader = sessions
    key = keys.registration(FLEET, "follower", "front")
    with reader.declare_subscriber(key) as subscriber:
        reader.put(key, make_registration(1).SerializeToString())
        sample = subscriber.recv()
    with Registrations(capacity=2, timeout_s=10) as stream:
        for _ in range(5):
            stream.offer(sample)
        assert [entry.message.sequence for entry in islice(stream, 2)] == [1, 1]
        assert stream.refused == 3


def test_silence_is_an_error_when_a_limit_was_given(sessions: tuple[zenoh.Session, zenoh.Session]) -> None:
    with waymark.registrations(sessions[1], fleet=FLEET, timeout_s=0.05) as stream:
        with pytest.raises(TimeoutError, match="no sample"):
            next(iter(stream))
