"""What 200 viewers that never read and 500 connections that never finish asking cost a follower.

    pressure.py WAYMARK [SECONDS]

Prints the frames registered per second without them, with them, and without them again, and whether others were served
meanwhile. Figures depend on the machine, so nothing here is a test: services/http/tests/face holds the bounds.
"""

import re
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from urllib.parse import urlsplit

from check_api import free_ports, get, until

VIEWERS, HALF_OPEN = 200, 500


def main(binary: str, seconds: float) -> None:
    follower, leader = (f"127.0.0.1:{port}" for port in free_ports(2))
    with tempfile.TemporaryDirectory() as recordings:
        command = [binary, "demo", "--headless", "--duration", "600s", "--recordings", recordings]
        command += ["--listen", follower, "--leader-listen", leader]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL) as demo:
            try:
                page = f"http://{follower}"
                until(lambda: get(f"{page}/readyz")["status"] == "ok")
                time.sleep(3)
                measure(page, seconds)
            finally:
                demo.terminate()


def measure(page: str, seconds: float) -> None:
    before = rate(page, seconds)
    clients = [never_reads(page) for _ in range(VIEWERS)] + [never_finishes(page) for _ in range(HALF_OPEN)]
    slowest_s = 0.0
    first, began = registered(page), time.monotonic()
    while time.monotonic() < began + seconds:
        asked = time.monotonic()
        assert get(f"{page}/api/v1/status")["role"] == "follower"
        slowest_s = max(slowest_s, time.monotonic() - asked)
        time.sleep(0.2)
    during = (registered(page) - first) / (time.monotonic() - began)
    for client in clients:
        client.close()
    after = rate(page, seconds)
    kept = during / ((before + after) / 2)
    print(f"registered per second: {before:.2f} before, {during:.2f} during, {after:.2f} after: {kept:.1%} kept")
    print(f"slowest status meanwhile: {slowest_s * 1e3:.0f} ms")
    for line in metrics(page).splitlines():
        if line.startswith("waymark_http_refused_total") and not line.endswith(" 0"):
            print(line)


def rate(page: str, seconds: float) -> float:
    first, began = registered(page), time.monotonic()
    time.sleep(seconds)
    return (registered(page) - first) / (time.monotonic() - began)


def metrics(page: str) -> str:
    with urllib.request.urlopen(f"{page}/metrics", timeout=10) as answer:
        return answer.read().decode()


def registered(page: str) -> int:
    found = re.search(r'waymark_frames_registered_total\{camera="front"\} (\d+)', metrics(page))
    assert found is not None
    return int(found[1])


def never_reads(page: str) -> socket.socket:
    client = connected(page)
    client.sendall(b"GET /api/v1/cameras/front/stream.mjpeg HTTP/1.1\r\nHost: localhost\r\n\r\n")
    return client


def never_finishes(page: str) -> socket.socket:
    client = connected(page)
    client.sendall(b"GET / HTTP/1.1\r\nHost: loc")
    return client


def connected(page: str) -> socket.socket:
    place = urlsplit(page)
    return socket.create_connection((place.hostname, place.port), timeout=10)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 12.0)
