#!/usr/bin/env python3
"""Puts the OpenCV peer beside the figures of `cargo bench -p vision --bench figures`, prints both as tables, and draws
how the time grows.

usage: figures.py FIGURES_TSV FRAMES SHARED GROWTH_SVG

FRAMES holds the frames that were measured (rink-WIDTHxHEIGHT.rgb), SHARED the folder with `peers/`; without it the peer
is left out. Thread CPU time, the smallest of several runs, one thread.
"""
import csv
import importlib.util
import pathlib
import sys
import time
import types

import numpy

SIZES = ["640x480", "1280x720", "1920x1080"]
RED = ((202.0, 71.0, 33.0), (30.0, 30.0, 30.0), (15, 50), 12)


def peer_us(shared, frames):
    """CPU microseconds of all 14 steps of the peer, for each size."""
    path = shared / "peers" / "statistical_gradient_opencv.py"
    if not path.exists():
        print(f"SKIPPED: no {path}; name the folder with WAYMARK_SHARED")
        return {}
    import cv2

    cv2.setNumThreads(1)
    spec = importlib.util.spec_from_file_location("peer", path)
    peer = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(peer)
    mean, variance, (mean_tolerance, variance_tolerance), window = RED
    template = types.SimpleNamespace(mean=numpy.array(mean), var=numpy.array(variance), w=window, h=window)
    times = {}
    for size in SIZES:
        width, height = map(int, size.split("x"))
        frame = numpy.fromfile(frames / f"rink-{size}.rgb", numpy.uint8).reshape(height, width, 3)
        smallest = float("inf")
        for _ in range(12):
            start = time.thread_time()
            peer.register(frame, template, mean_tolerance, variance_tolerance, (window, window))
            smallest = min(smallest, time.thread_time() - start)
        times[size] = 1e6 * smallest
    return times


def read(path):
    """{(figure, content, size, window, count): microseconds}"""
    figures = {}
    with open(path) as lines:
        for figure, content, width, height, window, count, us in csv.reader(lines, delimiter="\t"):
            figures[figure, content, f"{width}x{height}", int(window), int(count)] = float(us)
    return figures


def table(title, head, rows):
    """Prints a Markdown table."""
    print(f"\n{title}\n\n| {' | '.join(head)} |\n|{' --- |' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(row)} |")


def number(value):
    """Three digits are enough."""
    return "" if value is None else f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def ratios(figures, peer, lanes):
    """What the others take, as multiples of ours."""
    rows = []
    for name, times in [("OpenCV, all steps", peer)] + [
        (name, {size: figures.get((figure, "rink", size, window, count)) for size in SIZES})
        for name, figure, window, count in [("imageproc, all steps", "imageproc", 12, 1), ("JPEG decoding", "decode", 0, 0)]
    ]:
        row = [name]
        for size in SIZES:
            ours, theirs = figures[f"register-{lanes}", "match", size, 12, 1], times.get(size)
            row.append("" if theirs is None else f"{number(theirs)} µs, {theirs / ours:.1f} times")
        rows.append(row)
    ours = [number(figures[f"register-{lanes}", "match", size, 12, 1]) + " µs" for size in SIZES]
    table(f"All 14 steps, rink, window 12, {lanes}", ["", *SIZES], [["ours", *ours], *rows])


def contents(figures, figure):
    """A row for each content and window."""
    keys = sorted({(key[1], key[3]) for key in figures if key[0] == figure})
    rows = [
        [content, str(window), *(number(figures.get((figure, content, size, window, 1))) for size in SIZES)]
        for content, window in keys
    ]
    table(f"{figure}, µs", ["content", "window", *SIZES], rows)


def growth(figures, lanes):
    """Points of the three curves: name of the axis, and (how many times as much, how many times as long)."""
    pixels = [(w * h, figures[f"register-{lanes}", "match", f"{w}x{h}", 12, 1])
              for w, h in (map(int, size.split("x")) for size in SIZES)]
    dense = [(w * h, figures[f"register-{lanes}", "everything", f"{w}x{h}", 12, 1])
             for w, h in (map(int, size.split("x")) for size in SIZES)]
    landmarks = [(count, figures["landmarks", "distinct", SIZES[0], 12, count]) for count in (1, 8, 64)]
    objects = sorted((key[4] ** 2, us) for key, us in figures.items() if key[0] == f"object-{lanes}")
    return {"pixels": pixels, "pixels, all match": dense, "landmarks": landmarks, "object's area": objects}


def draw(curves, path):
    """A plot of time against size, both relative to the smallest and logarithmic; the dashed line is linear growth."""
    side, margin, most = 420, 50, 512.0
    place = lambda value: numpy.log(max(value, 1.0)) / numpy.log(most) * side
    colours = ["#1f6fb4", "#c23b22", "#2e8b57", "#8b5fbf"]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {side + 2 * margin + 110} {side + 2 * margin}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="100%" height="100%" fill="white"/><g transform="translate({margin},{margin})">',
        f'<rect width="{side}" height="{side}" fill="none" stroke="#999"/>',
        f'<line x1="0" y1="{side}" x2="{side}" y2="0" stroke="#999" stroke-dasharray="4"/>',
    ]
    for tick in (1, 4, 16, 64, 256):
        at = place(tick)
        parts.append(f'<text x="{at:.0f}" y="{side + 16}" text-anchor="middle">{tick}</text>')
        parts.append(f'<text x="-6" y="{side - at + 4:.0f}" text-anchor="end">{tick}</text>')
    parts.append(f'<text x="{side / 2}" y="{side + 36}" text-anchor="middle">times as much</text>')
    parts.append(f'<text transform="translate(-34,{side / 2}) rotate(-90)" text-anchor="middle">times as long</text>')
    for line, (colour, (name, points)) in enumerate(zip(colours, curves.items())):
        first, least = points[0]
        path_points = " ".join(f"{place(x / first):.1f},{side - place(us / least):.1f}" for x, us in points)
        parts.append(f'<polyline points="{path_points}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts.append(f'<text x="{side + 8}" y="{20 + 18 * line}" fill="{colour}">{name}</text>')
    pathlib.Path(path).write_text("\n".join([*parts, "</g></svg>", ""]))


def main():
    tsv, frames, shared, svg = sys.argv[1:]
    figures = read(tsv)
    peer = peer_us(pathlib.Path(shared), pathlib.Path(frames))
    names = {key[0] for key in figures}
    all_lanes = [lanes for lanes in ("avx512", "avx2", "baseline") if f"register-{lanes}" in names]
    for lanes in all_lanes:
        ratios(figures, peer, lanes)
        contents(figures, f"mask-{lanes}")
        contents(figures, f"register-{lanes}")
    gated = [[lanes, *(number(figures[f"gated-{lanes}", "block 24 px", size, 12, 1]) for size in SIZES)] for lanes in all_lanes]
    table("An object of 24 pixels in its gate, all steps, µs", ["", *SIZES], gated)
    rows = [[f"{count}, {content}", *(number(figures[figure, content, size, 12, count]) for size in SIZES)]
            for figure, content, count in sorted((*key[:2], key[4]) for key in figures if key[0].startswith("landmarks") and key[2] == SIZES[0])]
    table("Landmarks, µs; the last row: each by itself", ["landmarks", *SIZES], rows)
    stages = ["statistics", "mask", "components", "outline", "hough", "shape", "measure"]
    rows = [[stage, *(number(figures[stage, "match", size, 12, 1]) for size in SIZES)] for stage in stages]
    table("Stages, rink, µs", ["stage", *SIZES], rows)
    curves = growth(figures, all_lanes[0])
    rows = [[name, f"{points[-1][0] / points[0][0]:.3g}", f"{points[-1][1] / points[0][1]:.3g}"] for name, points in curves.items()]
    table("Growth", ["of", "times as much", "times as long"], rows)
    draw(curves, svg)


if __name__ == "__main__":
    main()
