#!/usr/bin/env python3
"""What our methods cost beside OpenCV, NumPy and imageproc, as a table.

usage: methods_figures.py FRAMES COMMAND...

COMMAND runs the bench `methods` of the vision crate, which prints `method, variant, width, height, microseconds`; FRAMES holds
the frames that it writes. Ours and the peers' take turns several times, one thread each, and the smallest CPU time counts:
so a busy machine slows all of them or none.
"""
import pathlib
import subprocess
import sys
import time

import cv2
import numpy
from horn_schunck_peer import horn_schunck, means_by_numpy

TURNS = 3
SIZES = [(640, 480), (1280, 720), (1920, 1080)]


def smallest_us(run):
    """CPU time of this thread: the smallest of several runs, at least five, within about a third of a second."""
    smallest, end = float("inf"), time.thread_time() + 0.3
    for number in range(50):
        if number >= 5 and time.thread_time() > end:
            break
        start = time.thread_time()
        run()
        smallest = min(smallest, time.thread_time() - start)
    return 1e6 * smallest


def peers(rgb):
    """(method and variant of ours, name, run) of everything that is compared."""
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    plane = grey.astype(numpy.float32)
    moved = numpy.roll(plane, -1, axis=1)
    window = cv2.createHanningWindow(plane.shape[::-1], cv2.CV_32F)

    def match(picture, side):
        return lambda: cv2.minMaxLoc(cv2.matchTemplate(picture, picture[200 : 200 + side, 300 : 300 + side], cv2.TM_CCOEFF_NORMED))

    yield ("ncc", "grey 24 px"), "cv2.matchTemplate", lambda: match(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY), 24)()
    yield ("ncc", "grey 48 px"), "cv2.matchTemplate", lambda: match(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY), 48)()
    yield ("ncc", "rgb 24 px"), "cv2.matchTemplate", match(rgb, 24)
    yield ("phase correlation", "Hann"), "cv2.phaseCorrelate", lambda: cv2.phaseCorrelate(plane, moved, window)
    yield ("Horn-Schunck", "100 iterations"), "NumPy and cv2.filter2D", lambda: horn_schunck(plane, moved, 15, 100)
    yield ("Horn-Schunck", "100 iterations"), "NumPy", lambda: horn_schunck(plane, moved, 15, 100, means_by_numpy)
    if grey.shape != (480, 640):
        return
    kernel = numpy.fromfunction(lambda y, x: x * y % 7, (31, 31)).astype(numpy.float32)
    yield ("gaussian", "sigma 1.5"), "cv2.GaussianBlur", lambda: cv2.GaussianBlur(plane, (13, 13), 1.5)
    yield ("low-pass", "5x5"), "cv2.blur", lambda: cv2.blur(plane, (5, 5))
    yield ("median", "3x3"), "cv2.medianBlur", lambda: cv2.medianBlur(plane, 3)
    yield ("bicubic", "doubled"), "cv2.resize", lambda: cv2.resize(plane, None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC)
    yield ("convolution 31x31", "by Fourier"), "cv2.filter2D", lambda: cv2.filter2D(plane, -1, kernel)
    yield ("Sobel", "magnitude"), "cv2.Sobel, cv2.magnitude", lambda: cv2.magnitude(
        cv2.Sobel(plane, cv2.CV_32F, 1, 0), cv2.Sobel(plane, cv2.CV_32F, 0, 1))
    yield ("Canny", "60, 150"), "cv2.Canny", lambda: cv2.Canny(grey, 60, 150, L2gradient=True)


def measure_ours(command, ours):
    """Takes the smaller of what stands in `ours` and what the command prints."""
    for line in subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines():
        method, variant, width, height, us = line.split("\t")
        key = (method, variant, int(width), int(height))
        ours[key] = min(ours.get(key, float("inf")), float(us))


def main():
    frames, command = pathlib.Path(sys.argv[1]), sys.argv[2:]
    cv2.setNumThreads(1)
    ours, theirs = {}, {}
    for _ in range(TURNS):
        measure_ours(command, ours)
        for width, height in SIZES:
            rgb = numpy.fromfile(frames / f"rink-{width}x{height}.rgb", numpy.uint8).reshape(height, width, 3)
            for subject, name, run in peers(rgb):
                key = (*subject, width, height, name)
                theirs[key] = min(theirs.get(key, float("inf")), smallest_us(run))
    print("| method | frame | ours, ms | peer, ms | peer / ours | peer |\n| --- | --- | --: | --: | --: | --- |")
    for (method, variant, width, height), us in ours.items():
        rows = [(name, peer_us) for (*key, name), peer_us in theirs.items() if tuple(key) == (method, variant, width, height)]
        for name, peer_us in rows or [("", None)]:
            figures = f"{peer_us / 1e3:.2f} | {peer_us / us:.1f}" if peer_us else " | "
            print(f"| {method}, {variant} | {width}×{height} | {us / 1e3:.2f} | {figures} | {name} |")


if __name__ == "__main__":
    main()
