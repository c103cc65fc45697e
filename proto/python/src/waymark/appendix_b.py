"""Prints one landmark of a recording as the reference thesis prints its Appendix B: a line for each frame.

Positions are frame pixels with the origin at the top-left corner; areas are those of the mask on the doubled grid,
as in the thesis. Where the thesis prints zeros for a frame without a measurement, the reason for the miss stands here.
"""

import argparse
from collections.abc import Iterable, Iterator

from waymark import recording
from waymark.v1.registration_pb2 import LandmarkResult, Miss, Registration


def rows(registrations: Iterable[Registration], landmark: str) -> Iterator[str]:
    """The table's lines; frames count from 1. Of several instances the one with the best score is taken."""
    for frame, registration in enumerate(registrations, 1):
        yield f"Frame= {frame}\t{_row(registration, landmark)}"


def _row(registration: Registration, landmark: str) -> str:
    results = [result for result in registration.landmarks if result.landmark == landmark]
    if not results:
        return "not looked for"
    best = max(results, key=lambda result: result.sighting.score if result.HasField("sighting") else -1.0)
    return _measured(best) if best.HasField("sighting") else _missed(best.miss)


def _measured(result: LandmarkResult) -> str:
    sighting = result.sighting
    position = f"X_pos= {sighting.centroid.x_px:.2f}\tY_pos= {sighting.centroid.y_px:.2f}"
    return f"{position}\tArea= {sighting.mask_area_2x:.2f}"


def _missed(miss: Miss) -> str:
    return "missed: " + Miss.Reason.Name(miss.reason).removeprefix("REASON_").lower().replace("_", " ")


def main() -> None:
    """The command ``waymark-appendix-b``."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recording", help="an MCAP recording of Waymark")
    parser.add_argument("--landmark", default="red", help="the landmark's id (default: red)")
    parser.add_argument("--camera", help="the camera's id; needed when the recording has several")
    arguments = parser.parse_args()

    registrations = [entry.message for entry in recording.registrations(arguments.recording)]
    cameras = sorted({registration.camera for registration in registrations})
    if arguments.camera is None and len(cameras) > 1:
        parser.error(f"the recording has several cameras, name one with --camera: {', '.join(cameras)}")
    camera = arguments.camera if arguments.camera is not None else "".join(cameras)
    if camera not in cameras:
        parser.error(f"camera '{camera}' is not in the recording; there are: {', '.join(cameras) or 'none'}")
    chosen = [registration for registration in registrations if registration.camera == camera]
    print("\n".join(rows(chosen, arguments.landmark)))


if __name__ == "__main__":
    main()
