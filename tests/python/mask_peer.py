#!/usr/bin/env python3
"""Compares our mask with that of an OpenCV implementation of the same 14 steps, pixel for pixel, on real frames.

usage: mask_peer.py MASK_EXAMPLE SHARED

MASK_EXAMPLE is the built example `mask` of the vision crate, SHARED the folder with `peers/` and `data/`. Needs numpy and
opencv-python-headless. The peer is given our six numbers; it computes in 32-bit floats, which excuses one pixel in ten
thousand. Only windows that lie wholly inside the frame are compared: at borders the peer invents pixels.
"""
import importlib.util
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy

LARGEST_DIFFERENT_SHARE = 1e-4

# Picture, means and variances of R, G, B, window (width, height), tolerances of mean and variance.
CASES = [
    ("rink/f037.jpg", (209.4, 73.7, 36.2), (91.2, 34.5, 31.9), (12, 12), (15, 50)),
    ("rink/f037.jpg", (202.3, 71.41, 32.9), (85.08, 40.07, 58.0), (7, 5), (40, 150)),
    ("rink/f090.jpg", (51.08, 59.94, 82.26), (40.28, 16.62, 38.85), (9, 12), (40, 70)),
    ("rink/f120.jpg", (180.0, 170.0, 160.0), (60.0, 60.0, 60.0), (16, 3), (40, 150)),
    ("orange_shirt/frames/0001.jpg", (188.0, 78.7, 33.6), (97.4, 56.5, 45.9), (12, 12), (40, 150)),
    ("orange_shirt/frames/0020.jpg", (162.3, 62.3, 24.2), (166.4, 72.5, 73.3), (25, 25), (40, 400)),
]


class Template:
    """What the peer takes from a template picture, given instead."""

    def __init__(self, mean, variance):
        self.mean, self.var = numpy.array(mean), numpy.array(variance)


def peer_mask(peer, picture, template, window, tolerance):
    """The peer's mask, cut to the windows that lie wholly inside."""
    width, height = window
    rgb = cv2.cvtColor(cv2.imread(str(picture)), cv2.COLOR_BGR2RGB)
    mean, variance = peer.stage_stats(peer.stage_up(rgb), width, height)
    mask = peer.stage_mask(mean, variance, template, *tolerance) > 0
    # OpenCV writes a window's result to the pixel at (width // 2, height // 2) of it; we name windows by their first one.
    return mask[height // 2 : mask.shape[0] - (height - 1) // 2, width // 2 : mask.shape[1] - (width - 1) // 2]


def our_mask(example, png, case, shape):
    """Our mask as the example writes it."""
    _, mean, variance, window, tolerance = case
    joined = [",".join(str(number) for number in numbers) for numbers in (mean, variance, window, tolerance)]
    with tempfile.NamedTemporaryFile() as out:
        subprocess.run([example, str(png), *joined, out.name], check=True)
        return numpy.fromfile(out.name, numpy.uint8).reshape(shape) > 0


def main():
    example, shared = sys.argv[1], pathlib.Path(sys.argv[2])
    spec = importlib.util.spec_from_file_location("peer", shared / "peers" / "statistical_gradient_opencv.py")
    peer = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(peer)
    failed = False
    for case in CASES:
        name, mean, variance, window, tolerance = case
        with tempfile.TemporaryDirectory() as folder:
            # Both read the same lossless pixels: two JPEG decoders may round differently.
            png = pathlib.Path(folder) / "frame.png"
            cv2.imwrite(str(png), cv2.imread(str(shared / "data" / "sequences" / name)))
            theirs = peer_mask(peer, png, Template(mean, variance), window, tolerance)
            ours = our_mask(example, png, case, theirs.shape)
        different = int((ours != theirs).sum())
        share = different / ours.size
        failed |= share > LARGEST_DIFFERENT_SHARE
        print(f"{name} window {window}: {int(ours.sum())} of {ours.size} set, {different} differ ({share:.1e})")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
