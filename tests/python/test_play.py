"""`waymark play` as a person uses it: keys on a terminal, and its control over HTTP."""

import json
import os
import pty
import socket
import subprocess
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

RECORDING = Path(__file__).parents[2] / "recordings/reference/rink.mcap"
# Far beyond what anything takes, so that a busy machine does not fail a test.
DEADLINE_S = 60


def free_address() -> str:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return f"127.0.0.1:{listener.getsockname()[1]}"


class Player:
    """A player of one recording in a terminal of its own, paused at its beginning."""

    def __init__(self, *options: str) -> None:
        binary = os.environ["WAYMARK_BIN"]
        endpoint, self.control = f"tcp/{free_address()}", free_address()
        self.router = subprocess.Popen([binary, "router", "--listen", endpoint], stderr=subprocess.DEVNULL)
        self.terminal, inside = pty.openpty()
        command = [binary, "play", str(RECORDING), "--paused", "--connect", endpoint, "--listen", self.control]
        self.process = subprocess.Popen([*command, *options], stdin=inside, stdout=inside, stderr=inside)
        os.close(inside)
        self.shown = b""
        # A terminal that nobody reads would make the player wait.
        threading.Thread(target=self.read_terminal, daemon=True).start()
        self.until(lambda status: status["paused"])

    def read_terminal(self) -> None:
        try:
            while text := os.read(self.terminal, 4096):
                self.shown += text
        except OSError:
            pass  # the other end is gone

    def press(self, keys: bytes) -> None:
        os.write(self.terminal, keys)

    def ask(self, command: str) -> int:
        request = urllib.request.Request(f"http://{self.control}/api/v1/player/{command}", method="POST")
        try:
            with urllib.request.urlopen(request) as answer:
                return int(answer.status)
        except urllib.error.HTTPError as error:
            assert error.headers.get_content_type() == "application/problem+json"
            return error.code

    def until(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        deadline, status = time.monotonic() + DEADLINE_S, {}
        while time.monotonic() < deadline:
            try:
                with urllib.request.urlopen(f"http://{self.control}/api/v1/player") as answer:
                    status = json.load(answer)
                if wanted(status):
                    return status
            except urllib.error.URLError:
                assert self.process.poll() is None, self.shown.decode(errors="replace")
            time.sleep(0.02)
        raise AssertionError(f"stays at {status}")

    def end(self) -> int:
        return self.process.wait(DEADLINE_S)

    def close(self) -> None:
        self.process.kill()
        self.router.kill()


@pytest.fixture
def player() -> Iterator[Player]:
    playing = Player()
    yield playing
    playing.close()


def test_keys(player: Player) -> None:
    begun = player.until(lambda status: status["position_s"] == 0)
    assert begun["rate"] == 1 and 6 < begun["duration_s"] < 7
    player.press(b"+")
    player.until(lambda status: status["rate"] == 2)
    player.press(b"--")
    player.until(lambda status: status["rate"] == 0.5)
    player.press(b" ")
    player.until(lambda status: not status["paused"] and status["position_s"] > 0.1)
    player.press(b" ")
    here = player.until(lambda status: status["paused"])["position_s"]
    player.press(b"b")
    player.until(lambda status: status["position_s"] < here)
    assert b"paused" in player.shown and b"of 6.6 s" in player.shown
    player.press(b"q")
    assert player.end() == 0


def test_http(player: Player) -> None:
    assert player.ask("seek?to_s=3") == 202
    sought = player.until(lambda status: status["position_s"] == 3)
    assert sought["paused"], "seeking does not set it going"
    for refused, status in {"rate?value=-1": 400, "rate": 400, "seek?to_s=x": 400, "seek?to=3": 400, "jump": 404}.items():
        assert player.ask(refused) == status, refused
    assert player.ask("rate?value=4") == 202
    assert player.ask("resume") == 202
    assert player.end() == 0, "it ends with the recording"
