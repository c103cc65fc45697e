#!/usr/bin/env python3
"""Compares each method of `vision::methods` with SciPy, scikit-image or OpenCV on real frames.

usage: methods_peer.py METHODS_EXAMPLE SHARED

METHODS_EXAMPLE is the built example `methods` of the vision crate, SHARED the folder with `data/`. Prints a line for each
method: with what it was compared, the largest difference, and the tolerance. Exits with 1 when one is exceeded.
"""
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy
from horn_schunck_peer import horn_schunck
from scipy import ndimage, signal
from skimage import filters, registration, transform

# Two neighbouring frames of real video, and two of a rendered sequence with noise, as 8-bit pictures.
PAIRS = [("orange_shirt/frames/0001.jpg", "orange_shirt/frames/0002.jpg"), ("rink/f037.jpg", "rink/f038.jpg")]
TEMPLATE = (slice(207, 227), slice(301, 325))
# The example's parts are fixed; frames are brought to this size.
WIDTH, HEIGHT = 640, 480


class Comparison:
    """What the example made of two frames, held against what others make of them."""

    def __init__(self, folder, first, second):
        self.folder, self.rgb = folder, first
        self.grey = cv2.cvtColor(first, cv2.COLOR_RGB2GRAY)
        self.plane = self.grey.astype(numpy.float32)
        self.exact = self.grey.astype(numpy.float64)
        self.next = cv2.cvtColor(second, cv2.COLOR_RGB2GRAY).astype(numpy.float32)
        self.failed = []

    def ours(self, name):
        return numpy.load(self.folder / f"{name}.npy")

    def close(self, name, peer, theirs, tolerance, ours=None):
        """Largest difference at most `tolerance`."""
        ours = self.ours(name) if ours is None else ours
        if ours.shape != theirs.shape:
            self.report(name, peer, f"shape {ours.shape} is not {theirs.shape}", False)
            return
        difference = float(numpy.abs(ours - theirs).max())
        self.report(name, peer, f"largest difference {difference:.2g}, tolerance {tolerance:g}", difference <= tolerance)

    def report(self, name, peer, text, passed):
        print(f"{'ok    ' if passed else 'FAILED'} {name:28} {peer:38} {text}")
        if not passed:
            self.failed.append(name)

    def check_filters(self):
        self.close("luma", "cv2.cvtColor", self.exact, 0)
        self.close("magnitude", "numpy.linalg.norm", numpy.linalg.norm(self.rgb.astype(float), axis=2), 1e-4)
        uniform = ndimage.uniform_filter(self.exact, size=(4, 5), mode="nearest")
        self.close("low-pass-5x4", "scipy.ndimage.uniform_filter", uniform, 1e-3)
        mirrored = ndimage.uniform_filter(self.exact, size=3, mode="mirror")
        self.close("low-pass-3x3-mirror", "scipy.ndimage.uniform_filter", mirrored, 1e-3)
        self.close("gaussian-1.5", "scipy.ndimage.gaussian_filter",
                   ndimage.gaussian_filter(self.exact, 1.5, mode="nearest"), 1e-3)
        self.close("median-3x3", "scipy.ndimage.median_filter",
                   ndimage.median_filter(self.exact, size=3, mode="nearest"), 0)
        padded = numpy.pad(self.exact, ((1, 0), (1, 0)), mode="edge")
        four = [padded[y : y + HEIGHT, x : x + WIDTH] for y in (0, 1) for x in (0, 1)]
        self.close("median-2x2", "numpy.median", numpy.median(four, axis=0), 0)

    def check_resolutions(self):
        for width, height in ((2 * WIDTH, 2 * HEIGHT), (512, 384)):
            def resized(flag):
                return cv2.resize(self.plane, (width, height), interpolation=flag)
            self.close(f"nearest-{width}x{height}", "cv2.resize INTER_NEAREST_EXACT", resized(cv2.INTER_NEAREST_EXACT), 0)
            self.close(f"bilinear-{width}x{height}", "cv2.resize INTER_LINEAR", resized(cv2.INTER_LINEAR), 0.05)
            scale = (WIDTH / width, HEIGHT / height)
            # Pixel numbers there, corners here.
            back = transform.AffineTransform(scale=scale, translation=(scale[0] / 2 - 0.5, scale[1] / 2 - 0.5))
            cubic = transform.warp(self.exact, back, output_shape=(height, width), order=3, mode="edge", clip=False)
            self.close(f"bicubic-{width}x{height}", "skimage.transform.warp order 3", cubic, 0.05)

    def check_convolutions(self):
        y, x = numpy.mgrid[:5, :6]
        kernel = ((3 * x + 7 * y) % 11 - 4).astype(float)
        for extent in ("full", "same", "valid"):
            self.close(f"convolution-{extent}", "scipy.signal.convolve2d",
                       signal.convolve2d(self.exact, kernel, mode=extent), 0.01)
            self.close(f"convolution-fourier-{extent}", "scipy.signal.fftconvolve",
                       signal.fftconvolve(self.exact, kernel, mode=extent), 0.05)

    def check_edges(self):
        for name, operator in (("sobel", ndimage.sobel), ("prewitt", ndimage.prewitt)):
            x, y = (operator(self.exact, axis=axis, mode="nearest") for axis in (1, 0))
            self.close(f"{name}-x", f"scipy.ndimage.{name}", x, 0)
            self.close(f"{name}-y", f"scipy.ndimage.{name}", y, 0)
            self.close(f"{name}-magnitude", f"scipy.ndimage.{name}", numpy.hypot(x, y), 1e-3)
        # Theirs divides by the root of two, and has another border.
        inside = (slice(1, -1), slice(1, -1))
        roberts = numpy.sqrt(2) * filters.roberts(self.exact)[inside]
        self.close("roberts-magnitude", "skimage.filters.roberts", roberts, 1e-3, self.ours("roberts-magnitude")[inside])
        canny = cv2.Canny(self.grey, 60, 150, L2gradient=True) / 255
        different = int((self.ours("canny") != canny).sum())
        self.report("canny", "cv2.Canny", f"{different} of {int(canny.sum())} edge pixels differ, tolerance 0", different == 0)

    def check_lines(self):
        edges = self.ours("canny") > 0
        theirs, angles, distances = transform.hough_line(edges, theta=numpy.arange(360) * numpy.pi / 360)
        ours = self.ours("hough-votes").T
        beyond = (theirs.shape[0] - ours.shape[0]) // 2
        theirs = theirs[beyond : theirs.shape[0] - beyond].astype(float)
        moved = int(numpy.abs(ours - theirs).sum()) // 2
        self.report("hough-votes", "skimage.transform.hough_line",
                    f"{moved} of {int(theirs.sum())} votes in a neighbouring cell, tolerance 1e-4",
                    moved <= 1e-4 * theirs.sum() and ours.shape == theirs.shape)
        rho, theta, votes = self.ours("hough-lines")[0]
        distance, angle = numpy.unravel_index(theirs.argmax(), theirs.shape)
        # Theirs are measured from the middle of the first pixel.
        rho_there = distances[beyond + distance] + (numpy.cos(angles[angle]) + numpy.sin(angles[angle])) / 2
        strongest = numpy.array([rho, theta, votes])
        self.close("hough-lines", "skimage.transform.hough_line",
                   numpy.array([rho_there, angles[angle], theirs.max()]), 1e-3, strongest)

    def check_control_points(self):
        given = [(10, 12), (600, 30), (25, 450), (620, 470), (300, 240), (100, 400)]
        to = [(14.5, 10), (590, 41), (31, 437), (633, 460), (308, 236.5), (107, 391)]
        terms = numpy.array([(v, w, v * w, 1) for v, w in given], float)
        coefficients = numpy.linalg.lstsq(terms, numpy.array(to, float), rcond=None)[0].T
        self.close("control-points", "numpy.linalg.lstsq", coefficients, 1e-4)
        y, x = numpy.mgrid[:HEIGHT, :WIDTH] + 0.5
        at = numpy.tensordot(coefficients, numpy.stack([x, y, x * y, numpy.ones_like(x)]), axes=1) - 0.5
        warped = ndimage.map_coordinates(self.exact, at[::-1], order=1, mode="nearest")
        self.close("warped", "scipy.ndimage.map_coordinates", warped, 0.05)

    def check_shifts(self):
        table = self.ours("shifts")
        for dx, dy, x, y, peak in table:
            error = max(abs(x - dx), abs(y - dy))
            whole = dx == round(dx) and dy == round(dy)
            tolerance = 0.002 if whole else 0.1
            if whole:
                part = lambda left, top: self.exact[60 + top : 260 + top, 60 + left : 316 + left]
                first, second = part(0, 0), part(-int(dx), -int(dy))
            else:
                part = lambda left, top: self.exact[20 + top : 380 + top, 20 + left : 500 + left].reshape(180, 2, 240, 2).mean((1, 3))
                first, second = part(0, 0), part(-round(2 * dx), -round(2 * dy))
            window = cv2.createHanningWindow(first.shape[::-1], cv2.CV_64F)
            (opencv_x, opencv_y), _ = cv2.phaseCorrelate(first, second, window)
            (skimage_y, skimage_x), *_ = registration.phase_cross_correlation(
                second * window, first * window, upsample_factor=100, normalization=None)
            self.report(f"shift {dx:g}, {dy:g}", "the truth",
                        f"off {error:.3f} px, tolerance {tolerance:g}; cv2.phaseCorrelate {max(abs(opencv_x - dx), abs(opencv_y - dy)):.3f}, "
                        f"skimage {max(abs(skimage_x - dx), abs(skimage_y - dy)):.3f}", error <= tolerance)

    def check_correlation(self):
        for name, picture in (("grey", self.grey), ("rgb", self.rgb)):
            surface = correlation_coefficients(picture.reshape(HEIGHT, WIDTH, -1).astype(float))
            self.close(f"ncc-{name}", "eq. 2.22, scipy.signal.correlate", surface, 5e-4)
            # Theirs is inexact where a window is nearly flat: there it is this far from the equation.
            theirs = cv2.matchTemplate(picture, picture[TEMPLATE], cv2.TM_CCOEFF_NORMED)
            self.close(f"ncc-{name}", "cv2.matchTemplate", theirs, 0.02)
            x, y, score = self.ours(f"ncc-{name}-match")[0]
            cut = (TEMPLATE[1].start, TEMPLATE[0].start)
            self.report(f"ncc-{name}-match", "where it was cut", f"{x:g}, {y:g} with {score:.5f}", (x, y) == cut and score > 0.999)

    def check_flow(self):
        u, v = horn_schunck(self.plane, self.next, 15, 100)
        self.close("flow-u", "NumPy and cv2.filter2D", u, 1e-3)
        self.close("flow-v", "NumPy and cv2.filter2D", v, 1e-3)

    def check(self):
        for check in (self.check_filters, self.check_resolutions, self.check_convolutions, self.check_edges, self.check_lines,
                      self.check_control_points, self.check_shifts, self.check_correlation, self.check_flow):
            check()


def correlation_coefficients(picture):
    """Eq. 2.22 over all channels, in 64-bit floats; 0 where a window is flat."""
    deviations = picture[TEMPLATE] - picture[TEMPLATE].mean((0, 1))
    samples = deviations.shape[0] * deviations.shape[1]
    ones = numpy.ones(deviations.shape[:2])
    numerator = variance = 0
    for channel in range(picture.shape[2]):
        levels = picture[:, :, channel]
        numerator = numerator + signal.correlate(levels - 128, deviations[:, :, channel], mode="valid")
        total, squares = (signal.correlate(what, ones, mode="valid") for what in (levels, levels**2))
        variance = variance + squares - total**2 / samples
    return numpy.where(variance > 0.5, numerator / numpy.sqrt(numpy.maximum(variance, 0.5) * (deviations**2).sum()), 0)


def main():
    example, shared = sys.argv[1], pathlib.Path(sys.argv[2])
    failed = []
    for names in PAIRS:
        print(f"--- {' and '.join(names)}")
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            pictures, paths = [], []
            for number, name in enumerate(names):
                picture = cv2.resize(cv2.imread(str(shared / "data" / "sequences" / name)), (WIDTH, HEIGHT))
                # Both read the same lossless pixels: two JPEG decoders may round differently.
                paths.append(folder / f"{number}.png")
                cv2.imwrite(str(paths[-1]), picture)
                pictures.append(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
            subprocess.run([example, *paths, folder], check=True)
            comparison = Comparison(folder, *pictures)
            comparison.check()
            failed += comparison.failed
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
