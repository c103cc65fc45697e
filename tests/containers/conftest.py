"""Convoys for the tests, one with each router; figures at the end."""

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import convoy as convoys
import images
import pytest
from convoy import Convoy, Face, eventually

BINARY = Path(os.environ.get("WAYMARK_BIN", images.ROOT / "target/debug/waymark"))
ZENOHD = Path(os.environ.get("ZENOHD_BIN", "/nonexistent"))


@pytest.fixture(scope="session", autouse=True)
def built_images() -> None:
    images.build_waymark(BINARY)
    if ZENOHD.is_file():
        images.build_zenohd(ZENOHD)


@pytest.fixture(scope="module", params=["waymark-router", "router"])
def convoy(request: pytest.FixtureRequest) -> Iterator[Convoy]:
    """The whole compose file, from nothing."""
    if request.param == "router" and not ZENOHD.is_file():
        pytest.skip("ZENOHD_BIN names no zenohd (cargo install zenohd)")
    convoy = Convoy(request.param)
    convoy.down()
    convoy.up()
    try:
        services = [convoy.router, "leader", *convoys.FOLLOWERS]
        all_healthy = lambda: all(convoy.health(service) == "healthy" for service in services)  # noqa: E731
        took_s = eventually("healthy", 300, all_healthy)
        convoys.figure(f"{convoy.router}: all healthy {took_s:.1f} s after `up` returned")
        for follower in convoys.FOLLOWERS:
            face = Face(convoy, follower)
            eventually(f"{follower} has the set", 60, lambda face=face: face.landmarks() == 2)  # type: ignore[misc]
        yield convoy
    finally:
        subprocess.run(["docker", "ps", "-a"], check=False)
        print(convoy.compose("logs", "--tail", "20"))
        convoy.down()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """What was measured."""
    for text in convoys.FIGURES:
        terminalreporter.write_line(f"figure: {text}")
