"""What a convoy outlives: leaders that leave, routers that die, links that break, peers that stall, packets that get lost.

Figures are printed at the end of the run; what is asserted holds on a machine that is slow and busy.
"""

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import waymark
import zenoh
from convoy import FOLLOWERS, Convoy, Events, Face, cut_off, docker, eventually, figure, largest_gap_s, packet_loss

pytestmark = pytest.mark.parametrize("convoy", ["waymark-router"], indirect=True, scope="module")

ONE, OTHER = FOLLOWERS


@pytest.fixture
def session(convoy: Convoy) -> Iterator[zenoh.Session]:
    """A client of the convoy's router that is no container."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["tcp/{convoy.address(convoy.router)}:7447"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as session:
        yield session


def test_a_router_killed_for_three_seconds_is_found_again(convoy: Convoy) -> None:
    face = Face(convoy, ONE)
    events = Events(face)
    events.await_more(1)
    convoy.signal(convoy.router, "KILL")
    eventually("the loss is seen", 60, lambda: not face.status()["router"]["connected"])
    time.sleep(3)
    convoy.start(convoy.router)
    took_s = eventually("reconnected", 60, lambda: bool(face.status()["router"]["connected"]))
    eventually("the leader is back", 60, lambda: bool(face.status()["leader"]["present"]))
    gap_s = largest_gap_s(events.frames())
    figure(f"router killed 3 s: reconnected {took_s:.1f} s after its start, largest gap between frames {gap_s:.2f} s")
    assert face.landmarks() == 2
    events.close()


def test_a_follower_cut_off_sees_on_and_every_gap_is_counted(convoy: Convoy, session: zenoh.Session) -> None:
    face = Face(convoy, ONE)
    with waymark.registrations(session, fleet="convoy", vehicle=ONE, capacity=100_000, timeout_s=120) as stream:
        received = iter(stream)
        events = Events(face)
        events.await_more(1)
        first = next(at for at in received if at.message.sequence >= events.frames()[0][1])
        missed_before, manifests_before = stream.missed, face.status()["leader"]["missed"]
        with cut_off(convoy.address(ONE), convoy.address(convoy.router)):
            convoy.ask_leader("retire", "blue")
            during = events.during(30)
        healed_s = eventually("reconnected", 60, lambda: bool(face.status()["router"]["connected"]))
        changed_s = healed_s + eventually("the change arrived", 60, lambda: face.landmarks() == 1)
        convoy.ask_leader("publish", "/landmarks/blue.json")
        eventually("the set is complete", 60, lambda: face.landmarks() == 2)
        missed_manifests = face.status()["leader"]["missed"] - manifests_before

        heard = {first.message.sequence}
        while max(heard) < during[-1][1] + 30:
            heard.add(next(received).message.sequence)
        missed = stream.missed - missed_before
        eventually("told of", 60, lambda: events.frames()[-1][1] >= max(heard))
        told = {number for _, number in events.frames() if min(heard) <= number <= max(heard)}
        lost = told - heard
    figure(
        f"cut off 30 s: reconnected {healed_s:.1f} s and in the leader's state {changed_s:.1f} s after the link healed; "
        f"largest gap between frames {largest_gap_s(during):.2f} s over {len(during)} frames"
    )
    figure(f"cut off 30 s: a listener counted {missed} missed registrations; {len(lost)} were sent and not heard")
    figure(f"cut off 30 s: the follower counted {missed_manifests} missed manifests")
    assert missed == len(lost) > 0
    assert len(during) > 30, "registration went on"
    assert largest_gap_s(during) < 8, "a pause that a lease or a timeout explains"
    assert missed_manifests > 0
    events.close()


def test_a_frozen_follower_and_a_stalled_querier_hold_up_nobody(convoy: Convoy) -> None:
    events = Events(Face(convoy, OTHER))
    events.await_more(30)
    usual_s = largest_gap_s(events.during(12))
    endpoint = f"tcp/{convoy.address(convoy.router)}:7447"
    querier = subprocess.Popen([sys.executable, Path(__file__).with_name("stalled_querier.py"), endpoint])
    convoy.signal(ONE, "STOP")
    try:
        frames = events.during(12)
        assert querier.poll() is None, "the querier has ended"
    finally:
        convoy.signal(ONE, "CONT")
        querier.kill()
        querier.wait()
    puts = Face(convoy, "leader").status()["puts"]
    figure(
        f"a follower and a querier frozen 12 s: largest gap at the other {largest_gap_s(frames):.3f} s "
        f"(before, all well: {usual_s:.3f} s); leader's longest put of the last minute {puts['longest_ms']:.2f} ms, "
        f"median {puts['median_ms']:.2f} ms"
    )
    assert largest_gap_s(frames) < 4, "a blocked put closes its transport after 5 s"
    assert puts["longest_ms"] < 4000
    eventually("the frozen one is back", 60, lambda: bool(Face(convoy, ONE).status()["leader"]["present"]))
    events.close()


def test_five_percent_of_packets_lost_cost_few_frames_and_no_landmark(convoy: Convoy) -> None:
    face = Face(convoy, ONE)
    events = Events(face)
    events.await_more(30)
    before = len(events.during(20)) / 20
    services = [convoy.router, "leader", *FOLLOWERS, f"{ONE}-camera", f"{OTHER}-camera"]
    with packet_loss([convoy.address(service) for service in services], 0.05):
        lossy = len(events.during(20)) / 20
        convoy.ask_leader("retire", "blue")
        for follower in FOLLOWERS:
            eventually("the retirement arrived", 60, lambda: Face(convoy, follower).landmarks() == 1)  # noqa: B023
        convoy.ask_leader("publish", "/landmarks/blue.json")
        for follower in FOLLOWERS:
            eventually("the landmark arrived", 60, lambda: Face(convoy, follower).landmarks() == 2)  # noqa: B023
    figure(
        f"5 % of packets lost: {lossy:.1f} of {before:.1f} frames a second ({100 * lossy / before:.0f} %), "
        f"{face.status()['cameras'][0]['dropped']['missed']} pictures missed since the start"
    )
    assert lossy > 0.5 * before
    events.close()


def test_a_new_follower_has_the_landmarks_of_a_leader_that_is_gone(convoy: Convoy) -> None:
    convoy.signal("leader", "KILL")
    convoy.compose("rm", "--force", "--stop", "-v", OTHER)
    docker("volume", "rm", "waymark-test_follower-2-state")
    convoy.up(OTHER)
    began = time.monotonic()
    eventually("answers", 60, lambda: Face(convoy, OTHER).status()["vehicle"] == OTHER)
    answered_s = time.monotonic() - began
    eventually("the set is there", 60, lambda: Face(convoy, OTHER).landmarks() == 2)
    figure(
        f"leader gone: a new follower answers {answered_s:.1f} s and has the landmarks "
        f"{time.monotonic() - began:.1f} s after `up` returned"
    )
    leader = Face(convoy, OTHER).status()["leader"]
    assert (leader["present"], leader["age_s"]) == (False, None)
    eventually("so does the other", 60, lambda: not Face(convoy, ONE).status()["leader"]["present"])
