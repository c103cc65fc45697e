"""Asks a running convoy everything that its own descriptions say may be asked, and more.

Schemathesis makes requests out of `/openapi.json`, allowed ones and others, and judges the answers: no server error, no
answer that is not described, nothing allowed refused, nothing else accepted. promtool reads the metrics.

    check_api.py WAYMARK
"""

import contextlib
import json
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

DEADLINE_S = 120.0
EXAMPLES = 12
HERE = Path(__file__).parent


def main(binary: str) -> int:
    follower, leader = (f"127.0.0.1:{port}" for port in free_ports(2))
    with tempfile.TemporaryDirectory() as recordings:
        command = [binary, "demo", "--headless", "--duration", "600s", "--recordings", recordings]
        command += ["--listen", follower, "--leader-listen", leader]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL) as demo:
            try:
                return check(f"http://{follower}", f"http://{leader}")
            finally:
                demo.terminate()


def free_ports(count: int) -> list[int]:
    """Ports that nobody listened on a moment ago."""
    with contextlib.ExitStack() as sockets:
        bound = [sockets.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(count)]
        return [one.getsockname()[1] for one in bound]


def check(follower: str, leader: str) -> int:
    until(lambda: get(f"{follower}/readyz")["status"] == "ok")
    until(lambda: get(f"{leader}/api/v1/status")["cameras"][0]["state"] == "live")
    # Something to ask for: a finished recording, and a picture to learn from.
    post(f"{follower}/api/v1/recorder/split")
    until(lambda: any(one["cameras"] for one in get(f"{follower}/api/v1/recordings")["recordings"]))
    post(f"{leader}/api/v1/lessons?camera=front")
    failed = [page for page in (follower, leader) for ask in (metrics, fuzz) if not ask(page)]
    return 1 if failed else 0


def fuzz(page: str) -> bool:
    program = Path(sys.executable).with_name("schemathesis")
    options = ["--config-file", str(HERE / "schemathesis.toml"), "run", f"{page}/openapi.json"]
    # Streams never end, so there is no whole answer to judge.
    options += ["--seed", "1", "--max-examples", str(EXAMPLES), "--exclude-path-regex", "events|mjpeg", "--no-color"]
    with tempfile.TemporaryDirectory() as place:
        return subprocess.run([program, *options], cwd=place, check=False).returncode == 0


def metrics(page: str) -> bool:
    promtool = shutil.which("promtool")
    if promtool is None:
        print("SKIPPED: no promtool; it is in Debian's package prometheus")
        return True
    with urllib.request.urlopen(f"{page}/metrics", timeout=10) as answer:
        text = answer.read()
    return subprocess.run([promtool, "check", "metrics"], input=text, check=False).returncode == 0


def get(address: str) -> dict:
    with urllib.request.urlopen(address, timeout=10) as answer:
        return json.load(answer)


def post(address: str) -> None:
    request = urllib.request.Request(address, method="POST")
    urllib.request.urlopen(request, timeout=10).close()


def until(condition) -> None:
    deadline = time.monotonic() + DEADLINE_S
    while True:
        try:
            if condition():
                return
        except OSError:
            pass
        if time.monotonic() > deadline:
            raise SystemExit("the convoy did not come to life")
        time.sleep(0.1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
