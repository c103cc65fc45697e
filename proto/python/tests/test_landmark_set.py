"""The view of a leader's set: any order, duplicates, restarts, retirements."""

from examples import make_landmark, make_manifest

from waymark import LandmarkView, Retired


def test_a_landmark_is_a_change_once() -> None:
    view = LandmarkView()
    red = make_landmark("red")
    assert view.on_landmark(red) == [red]
    assert view.on_landmark(red) == []


def test_older_revisions_and_epochs_are_ignored() -> None:
    view = LandmarkView()
    view.on_landmark(make_landmark("red", epoch=2, revision=1, red_mean=100))
    assert view.on_landmark(make_landmark("red", epoch=1, revision=9, red_mean=90)) == []
    assert view.landmarks["red"].shades[0].mean[0] == 100


def test_the_same_content_in_a_new_epoch_is_no_change() -> None:
    view = LandmarkView()
    view.on_landmark(make_landmark("red", epoch=1))
    assert view.on_landmark(make_landmark("red", epoch=2)) == []
    assert view.landmarks["red"].epoch == 2


def test_what_the_whole_set_lacks_is_retired() -> None:
    red, blue = make_landmark("red"), make_landmark("blue")
    view = LandmarkView()
    assert view.on_whole_set([red, blue, red]) == [red, blue]
    view.on_manifest(make_manifest([blue], version=2))
    assert not view.complete
    assert view.on_whole_set([blue]) == [Retired("red")]
    assert view.complete


def test_an_incomplete_reply_retires_nothing() -> None:
    red, blue = make_landmark("red"), make_landmark("blue")
    view = LandmarkView()
    view.on_manifest(make_manifest([red, blue], version=1))
    view.on_whole_set([red, blue])
    assert view.on_whole_set([red]) == []
    assert set(view.landmarks) == {"red", "blue"}


def test_an_older_manifest_is_ignored() -> None:
    red, blue = make_landmark("red"), make_landmark("blue")
    view = LandmarkView()
    view.on_manifest(make_manifest([red], version=5, epoch=2))
    view.on_manifest(make_manifest([red, blue], version=9, epoch=1))
    view.on_whole_set([red])
    assert view.complete
