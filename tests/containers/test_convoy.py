"""The convoy of docker-compose.yml with either router: comes up, follows its leader, runs without rights.

Needs a Docker engine (DOCKER_HOST) and a built binary (WAYMARK_BIN); `tests/run containers` says so when one is missing.
"""

import subprocess
import time

import images
import pytest
from convoy import FOLLOWERS, NETWORK, Convoy, Face, docker, eventually, figure


def test_both_followers_have_the_leader_its_landmarks_and_frames(convoy: Convoy) -> None:
    for follower in FOLLOWERS:
        face = Face(convoy, follower)
        before = face.frames()
        eventually(f"{follower} goes on", 60, lambda: face.frames() > before)
        eventually("the leader is present", 60, lambda: bool(face.status()["leader"]["present"]))


def test_the_containers_run_without_root_and_cannot_write_their_image(convoy: Convoy) -> None:
    for service in ("leader", *FOLLOWERS, f"{FOLLOWERS[0]}-camera"):
        container = convoy.container(service)
        assert docker("exec", container, "id", "-u") == "65532"
        attempt = subprocess.run(["docker", "exec", container, "touch", "/usr/local/bin/x"], capture_output=True)
        assert attempt.returncode != 0


def test_a_second_follower_of_the_same_id_is_refused_naming_the_first(convoy: Convoy) -> None:
    first = docker("exec", convoy.container("follower-1"), "hostname")
    began = time.monotonic()
    ran = subprocess.run(
        ["docker", "run", "--rm", "--network", NETWORK, images.WAYMARK, "follower"]
        + ["--set", "vehicle=follower-1", "--set", 'zenoh.connect=["tcp/router:7447"]']
        + ["--set", "state_dir=/var/lib/waymark", "--set", "recorder.directory=/recordings"],
        capture_output=True,
        text=True,
        timeout=120,
    )
    figure(f"{convoy.router}: a second follower refused after {time.monotonic() - began:.1f} s, container and all")
    assert ran.returncode == 1, ran.stderr
    assert f"on {first}" in ran.stderr


@pytest.mark.parametrize("follower", ["follower-2"])
def test_the_same_follower_restarts_after_a_hard_kill(convoy: Convoy, follower: str) -> None:
    convoy.signal(follower, "KILL")
    eventually("it has ended", 60, lambda: not convoy_runs(convoy, follower))
    began = time.monotonic()
    convoy.start(follower)
    eventually("it answers", 60, lambda: Face(convoy, follower).status()["vehicle"] == follower)
    figure(f"{convoy.router}: {follower} answers {time.monotonic() - began:.1f} s after its start")
    eventually("frames arrive again", 60, lambda: Face(convoy, follower).frames() > 0)


def convoy_runs(convoy: Convoy, service: str) -> bool:
    """Whether its container runs."""
    return docker("inspect", "-f", "{{.State.Running}}", convoy.container(service)) == "true"
