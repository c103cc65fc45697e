"""Layouts that other programs rely on."""

import pytest
from examples import make_landmark

from waymark import Attachment, keys
from waymark.attachment import GapCounter
from waymark.digest import landmark_digest, set_digest
from waymark.v1 import ColorStats, Landmark, ShapeClass


def test_the_attachment_has_the_layout_of_rmw_zenoh() -> None:
    attachment = Attachment(sequence=258, source_time_ns=-2, gid=b"0123456789abcdef")
    wire = attachment.to_bytes()
    assert wire == b"\x02\x01" + bytes(6) + b"\xfe" + b"\xff" * 7 + b"\x10" + b"0123456789abcdef"
    assert Attachment.from_bytes(wire) == attachment


@pytest.mark.parametrize("damaged", [b"", bytes(32), bytes(33), bytes(34)])
def test_other_attachments_are_refused(damaged: bytes) -> None:
    with pytest.raises(ValueError, match="33 bytes"):
        Attachment.from_bytes(damaged)


def test_gaps_are_counted_for_each_publisher() -> None:
    gaps = GapCounter()
    for gid, sequence in [(b"a" * 16, 7), (b"b" * 16, 100), (b"a" * 16, 8), (b"a" * 16, 12), (b"a" * 16, 9)]:
        gaps.observe(Attachment(sequence, 0, gid))
    gaps.observe(None)
    assert gaps.missed == 3


def test_keys_take_ids_and_wildcards() -> None:
    assert keys.landmark("convoy", "leader", "red") == "waymark/v1/convoy/leader/landmark/red"
    assert keys.landmark_set("convoy", "leader") == "waymark/v1/convoy/leader/landmark/**"
    assert keys.registration("convoy", "*", "*") == "waymark/v1/convoy/*/camera/*/registration"


@pytest.mark.parametrize("name", ["", "Red", "a/b", "**", "a" * 64, "-a"])
def test_names_that_are_no_ids_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="is no id"):
        keys.landmark("convoy", "leader", name)


def test_the_digests_are_those_of_the_test_vector_in_landmark_proto() -> None:
    landmark = Landmark(
        id="red",
        window_width_px=12,
        window_height_px=8,
        shades=[ColorStats(mean=[176.5, 32, 41.25], variance=[90, 60.5, 55])],
        tolerance=ColorStats(mean=[15] * 3, variance=[50] * 3),
        shape=ShapeClass.SHAPE_CLASS_BLOCK,
        size_m=0.4,
    )
    landmark.digest = landmark_digest(landmark)
    assert landmark.digest.hex() == "062504781e71e47ad2ff8f2a3e9b60f9bfcfbe3972d0cf42fc90cb7154825762"
    assert set_digest([landmark]).hex() == "04865ab884aad2551eda642ea448500602344e1518929c3cd0528cc4b9e65793"


def test_the_digest_changes_with_content_but_not_with_revision() -> None:
    digest = landmark_digest(make_landmark("red"))
    assert landmark_digest(make_landmark("red", revision=2, epoch=3)) == digest
    assert landmark_digest(make_landmark("red", red_mean=121)) != digest
    sized = make_landmark("red")
    sized.size_m = 0.5
    assert landmark_digest(sized) != digest
