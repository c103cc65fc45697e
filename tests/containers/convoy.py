"""The convoy of docker-compose.yml, and what may happen to it."""

import json
import os
import shutil
import subprocess
import threading
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import images

PROJECT = "waymark-test"
NETWORK = f"{PROJECT}_default"
FOLLOWERS = ("follower-1", "follower-2")

FIGURES: list[str] = []
"""What was measured, for the end of the run; figures are told, not judged."""


def figure(text: str) -> None:
    """Keeps a measured figure."""
    FIGURES.append(text)


def docker(*arguments: str, check: bool = True) -> str:
    """Runs docker and returns what it says."""
    ran = subprocess.run(["docker", *arguments], stdout=subprocess.PIPE, text=True, check=check)
    return ran.stdout.strip()


class Convoy:
    """A running convoy with one of the two routers."""

    def __init__(self, router: str) -> None:
        self.router = router
        self._scale = ["--scale", "router=0"] if router == "waymark-router" else []

    def compose(self, *arguments: str) -> str:
        """Runs compose, v1 or v2, with our images and free ports."""
        program = ["docker-compose"] if shutil.which("docker-compose") else ["docker", "compose"]
        profile = ["--profile", "waymark-router"] if self.router == "waymark-router" else []
        free_ports = {f"{name}_PORT": "0" for name in ("LEADER", "FOLLOWER_1", "FOLLOWER_2")}
        environment = {**os.environ, **free_ports, "WAYMARK_IMAGE": images.WAYMARK, "ZENOH_IMAGE": images.ZENOHD}
        command = [*program, "-p", PROJECT, *profile, *arguments]
        ran = subprocess.run(
            command, cwd=images.ROOT, env=environment, check=True, text=True, stdout=subprocess.PIPE
        )
        return ran.stdout.strip()

    def up(self, *services: str) -> None:
        """Starts these services, or all."""
        alone = ["--no-deps"] if services else []
        self.compose("up", "--detach", *self._scale, *alone, *services)

    def down(self) -> None:
        """Takes everything away, volumes too."""
        self.compose("down", "--volumes", "--remove-orphans", "--timeout", "3")

    def container(self, service: str) -> str:
        """The id of a service's container."""
        return self.compose("ps", "-q", service)

    def address(self, service: str) -> str:
        """A service's address in the convoy's network."""
        form = "{{range .NetworkSettings.Networks}}{{.IPAddress}}{{end}}"
        return docker("inspect", "-f", form, self.container(service))

    def health(self, service: str) -> str:
        """What its own health check says."""
        return docker("inspect", "-f", "{{.State.Health.Status}}", self.container(service))

    def signal(self, service: str, name: str) -> None:
        """Sends a signal to a service's process."""
        docker("kill", "-s", name, self.container(service))

    def start(self, service: str) -> None:
        """Starts a service's container again."""
        docker("start", self.container(service))

    def ask_leader(self, *arguments: str) -> str:
        """Runs `waymark landmark …` in the leader's container."""
        command = ["/usr/local/bin/waymark", "landmark", *arguments, "--router", "tcp/router:7447"]
        return docker("exec", self.container("leader"), *command)


class Face:
    """A service's web face, by its address in the network: containers may be cut off from each other, not from here."""

    def __init__(self, convoy: Convoy, service: str) -> None:
        self.service = service
        self.root = f"http://{convoy.address(service)}:{8081 if service == 'leader' else 8080}"

    def status(self) -> dict[str, Any]:
        """What it says of itself."""
        with urllib.request.urlopen(f"{self.root}/api/v1/status", timeout=5) as answer:
            document: dict[str, Any] = json.load(answer)
            return document

    def frames(self) -> int:
        """Number of the newest registered frame."""
        return int(self.status()["cameras"][0]["sequence"] or 0)

    def landmarks(self) -> int:
        """Landmarks in force."""
        return int(self.status()["landmarks"])


class Events:
    """The frames that a follower registers, as it tells of them, with the time of their arrival here."""

    def __init__(self, face: Face) -> None:
        self._answer = urllib.request.urlopen(f"{face.root}/api/v1/events", timeout=120)
        self._frames: list[tuple[float, int]] = []
        self._changed = threading.Condition()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        try:
            for line in self._answer:
                if line.startswith(b"data:"):
                    sequence = json.loads(line[5:]).get("sequence")
                    with self._changed:
                        self._frames.append((time.monotonic(), int(sequence)))
                        self._changed.notify_all()
        except (OSError, ValueError, AttributeError):
            return  # closed

    def frames(self) -> list[tuple[float, int]]:
        """Arrival, monotonic seconds, and number of every frame so far."""
        with self._changed:
            return list(self._frames)

    def await_more(self, count: int, limit_s: float = 120) -> None:
        """Waits for this many more frames."""
        with self._changed:
            wanted = len(self._frames) + count
            assert self._changed.wait_for(lambda: len(self._frames) >= wanted, limit_s), "frames stopped"

    def during(self, span_s: float) -> list[tuple[float, int]]:
        """The frames of the next seconds."""
        begin = time.monotonic()
        time.sleep(span_s)
        end = time.monotonic()
        return [(at, number) for at, number in self.frames() if begin <= at <= end]

    def close(self) -> None:
        """Ends the stream."""
        self._answer.close()


def largest_gap_s(frames: list[tuple[float, int]]) -> float:
    """The longest time between two frames."""
    return max((later - earlier for (earlier, _), (later, _) in zip(frames, frames[1:])), default=float("inf"))


def eventually(what: str, limit_s: float, condition: Callable[[], bool]) -> float:
    """Asks until it is true; returns how long that took. Refused connections count as not yet."""
    began = time.monotonic()
    while True:
        try:
            if condition():
                return time.monotonic() - began
            what_now = "not yet"
        except (OSError, KeyError, IndexError, subprocess.CalledProcessError) as error:
            what_now = repr(error)
        if time.monotonic() - began > limit_s:
            raise AssertionError(f"{what} not within {limit_s} s: {what_now}")
        time.sleep(0.05)


@contextmanager
def cut_off(one: str, other: str) -> Iterator[None]:
    """Nothing passes between two addresses, and nobody is told so."""
    rules = [["-s", one, "-d", other, "-j", "DROP"], ["-s", other, "-d", one, "-j", "DROP"]]
    with firewall(rules):
        yield


@contextmanager
def packet_loss(addresses: list[str], probability: float) -> Iterator[None]:
    """Every packet to these addresses may be lost."""
    chance = ["-m", "statistic", "--mode", "random", "--probability", str(probability)]
    with firewall([["-d", address, *chance, "-j", "DROP"] for address in addresses]):
        yield


@contextmanager
def firewall(rules: list[list[str]]) -> Iterator[None]:
    """Rules in the chain that Docker leaves to us."""
    for rule in rules:
        subprocess.run(["iptables", "-w", "-I", "DOCKER-USER", *rule], check=True)
    try:
        yield
    finally:
        for rule in rules:
            subprocess.run(["iptables", "-w", "-D", "DOCKER-USER", *rule], check=True)
