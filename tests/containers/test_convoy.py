"""The convoy of docker-compose.yml: comes up, follows its leader, and outlives its parts.

Needs a Docker engine (DOCKER_HOST) and a built binary (WAYMARK_BIN); `tests/run containers` says so when one is missing.
"""

import json
import os
import shutil
import subprocess
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import images
import pytest

FOLLOWERS = {"follower-1": 8080, "follower-2": 8082}
BINARY = Path(os.environ.get("WAYMARK_BIN", images.ROOT / "target/debug/waymark"))


def compose(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs compose, v1 or v2, with our image and our router."""
    program = ["docker-compose"] if shutil.which("docker-compose") else ["docker", "compose"]
    # The default router is scaled to none, but compose wants its image all the same.
    environment = {**os.environ, "WAYMARK_IMAGE": images.WAYMARK, "ZENOH_IMAGE": images.WAYMARK}
    command = [*program, "-p", "waymark-test", "--profile", "waymark-router", *arguments]
    return subprocess.run(command, cwd=images.ROOT, env=environment, check=True, text=True, **options)


def container(service: str) -> str:
    """The id of a service's container."""
    return compose("ps", "-q", service, stdout=subprocess.PIPE).stdout.strip()


def status(follower: str) -> dict[str, Any]:
    """What a follower says of itself."""
    address = f"http://127.0.0.1:{FOLLOWERS[follower]}/api/v1/status"
    with urllib.request.urlopen(address, timeout=5) as answer:
        document: dict[str, Any] = json.load(answer)
        return document


def eventually(what: str, limit_s: float, condition: Callable[[], bool]) -> float:
    """Asks until it is true; returns how long that took. Refused connections count as not yet."""
    began = time.monotonic()
    while True:
        try:
            if condition():
                return time.monotonic() - began
        except (OSError, KeyError, IndexError) as error:
            what_now = repr(error)
        else:
            what_now = "not yet"
        if time.monotonic() - began > limit_s:
            raise AssertionError(f"{what} not within {limit_s} s: {what_now}")
        time.sleep(0.1)


def frames(follower: str) -> int:
    """Number of the newest registered frame."""
    return int(status(follower)["cameras"][0]["sequence"] or 0)


def landmarks(follower: str) -> int:
    """Landmarks in force."""
    return int(status(follower)["landmarks"])


@pytest.fixture(scope="module")
def convoy() -> Iterator[None]:
    """The whole compose file, from nothing."""
    images.build_all(BINARY)
    compose("down", "--volumes", "--remove-orphans")
    compose("up", "--detach", "--scale", "router=0")
    try:
        yield
    finally:
        subprocess.run(["docker", "ps", "-a"], check=False)
        compose("logs", "--tail", "20")
        compose("down", "--volumes", "--remove-orphans")


def is_healthy(service: str) -> bool:
    """By its own health check."""
    form = "{{.State.Health.Status}}"
    said = subprocess.check_output(["docker", "inspect", "-f", form, container(service)], text=True)
    return said.strip() == "healthy"


def test_everything_is_healthy_and_both_followers_follow(convoy: None) -> None:
    services = ["waymark-router", "leader", *FOLLOWERS]
    took_s = eventually("healthy", 60, lambda: all(is_healthy(service) for service in services))
    print(f"all healthy after {took_s:.1f} s")
    for follower in FOLLOWERS:
        eventually(f"{follower} has the landmarks", 10, lambda f=follower: landmarks(f) >= 2)  # type: ignore[misc]
        before = frames(follower)
        eventually(f"{follower} goes on", 10, lambda f=follower, n=before: frames(f) > n)  # type: ignore[misc]


def test_the_containers_run_without_root_and_cannot_write_their_image(convoy: None) -> None:
    for follower in FOLLOWERS:
        user = subprocess.check_output(["docker", "exec", container(follower), "id", "-u"], text=True)
        assert user.strip() == "65532"
        attempt = subprocess.run(["docker", "exec", container(follower), "touch", "/usr/local/bin/x"])
        assert attempt.returncode != 0


def test_the_router_killed_for_three_seconds_is_found_again(convoy: None) -> None:
    follower = "follower-1"
    router = container("waymark-router")
    subprocess.run(["docker", "kill", router], check=True, stdout=subprocess.DEVNULL)
    eventually("the loss is seen", 15, lambda: not status(follower)["router"]["connected"])
    time.sleep(3)
    subprocess.run(["docker", "start", router], check=True, stdout=subprocess.DEVNULL)
    eventually("reconnected", 10, lambda: bool(status(follower)["router"]["connected"]))
    before = frames(follower)
    eventually("frames arrive again", 10, lambda: frames(follower) > before)
    assert landmarks(follower) >= 2


def test_a_new_follower_has_the_landmarks_of_a_leader_that_is_gone(convoy: None) -> None:
    compose("kill", "leader")
    compose("rm", "--force", "--stop", "-v", "follower-2")
    subprocess.run(["docker", "volume", "rm", "waymark-test_follower-2-state"], check=True)
    compose("up", "--detach", "--scale", "router=0", "--no-deps", "follower-2")
    eventually("answers", 20, lambda: status("follower-2")["vehicle"] == "follower-2")
    took_s = eventually("the set is there", 5, lambda: landmarks("follower-2") >= 2)
    print(f"landmarks {took_s:.1f} s after the first answer")
    eventually("the leader is shown as gone", 15, lambda: not status("follower-2")["leader"]["present"])
