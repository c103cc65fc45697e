"""The landmark set of one leader as a listener knows it. No Zenoh here: messages in, changes out."""

from collections.abc import Iterable
from dataclasses import dataclass

from waymark.digest import set_digest
from waymark.v1.landmark_pb2 import Landmark, LandmarkManifest


@dataclass(frozen=True, slots=True)
class Retired:
    """A landmark that the leader's set no longer has."""

    landmark_id: str


Change = Landmark | Retired


class LandmarkView:
    """Takes descriptors and manifests in any order; older ones than it knows change nothing."""

    def __init__(self) -> None:
        self._landmarks: dict[str, Landmark] = {}
        self._manifest: LandmarkManifest | None = None

    @property
    def landmarks(self) -> dict[str, Landmark]:
        """All landmarks in force, by id."""
        return dict(self._landmarks)

    @property
    def complete(self) -> bool:
        """Whether the set is the one of the newest manifest; false before the first."""
        return self._manifest is not None and set_digest(self._landmarks.values()) == self._manifest.digest

    def on_manifest(self, manifest: LandmarkManifest) -> None:
        """Takes note of what the set should be."""
        if self._manifest is None or _version(manifest) > _version(self._manifest):
            self._manifest = manifest

    def on_landmark(self, landmark: Landmark) -> list[Change]:
        """A descriptor that was published, or a reply."""
        known = self._landmarks.get(landmark.id)
        if known is not None and (landmark.epoch, landmark.revision) <= (known.epoch, known.revision):
            return []
        self._landmarks[landmark.id] = landmark
        return [] if known is not None and known.digest == landmark.digest else [landmark]

    def on_whole_set(self, replies: Iterable[Landmark]) -> list[Change]:
        """All replies to a query for the set. What they lack is retired when they are what the manifest promised."""
        replies = list(replies)
        changes = [change for landmark in replies for change in self.on_landmark(landmark)]
        newest = {landmark.id: self._landmarks[landmark.id] for landmark in replies}
        if self._manifest is not None and set_digest(newest.values()) == self._manifest.digest:
            for landmark_id in sorted(self._landmarks.keys() - newest.keys()):
                del self._landmarks[landmark_id]
                changes.append(Retired(landmark_id))
        return changes


def _version(manifest: LandmarkManifest) -> tuple[int, int]:
    return (manifest.epoch, manifest.version)
