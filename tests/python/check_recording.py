#!/usr/bin/env python3
"""Reads recordings as strictly as the PyPI packages `mcap` and `mcap-protobuf-support` can.

    check_recording.py FILE...

Every CRC is validated, every message is decoded with the schema in the file, and what the file says of itself
(statistics, accounts) is held against what is in it. Prints one JSON object for each file; exits with 1 when a file
is wrong, with 3 when it is right and says that messages were lost, with 0 otherwise.
"""

import json
import re
import sys
from collections import Counter
from pathlib import Path

from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import Attachment, Metadata
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

TOPIC = re.compile(
    r"/(?P<vehicle>[a-z0-9][a-z0-9_-]{0,62})/"
    r"(camera/[a-z0-9][a-z0-9_-]{0,62}/[a-z_]+(/again)?|landmark|manifest|status|log|guidance|odometry|scene|tf)|/log|/scene|/tf"
)
NS_PER_S = 1_000_000_000


def timestamp_ns(stamp):
    """Nanoseconds of a google.protobuf.Timestamp."""
    return stamp.seconds * NS_PER_S + stamp.nanos


class Recording:
    """What one pass over a file gathers, and what is wrong with it."""

    def __init__(self, path):
        self.path = path
        self.problems = []
        self.counts = Counter()
        self.image_times = {}
        self.annotation_times = {}
        self.first_image_index = None
        self.landmark_seen_before_images = False

    def require(self, holds, problem):
        if not holds:
            self.problems.append(problem)

    def read_messages(self):
        """Decodes everything in file order; a CRC or schema fault raises."""
        with open(self.path, "rb") as stream:
            reader = NonSeekingReader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
            for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
                self.counts[channel.topic] += 1
                self.require(schema.encoding == "protobuf", f"{channel.topic}: schema encoding {schema.encoding!r}")
                self.require(schema.name == decoded.DESCRIPTOR.full_name, f"{channel.topic}: decodes as another type")
                self.require("key_expression" in channel.metadata, f"{channel.topic}: channel has no key_expression")
                self.require(TOPIC.fullmatch(channel.topic), f"{channel.topic}: no topic of the contract")
                self.note(channel.topic, message, decoded)

    def note(self, topic, message, decoded):
        """Keeps what the comparisons between topics need."""
        if topic.endswith("/image"):
            captured_ns = timestamp_ns(decoded.timestamp)
            self.image_times.setdefault(topic, set()).add(captured_ns)
            self.require(message.publish_time == captured_ns, f"{topic}: publish_time is not the capture time")
        if topic.endswith("/annotations"):
            times = {timestamp_ns(item.timestamp) for kind in ("circles", "points", "texts")
                     for item in getattr(decoded, kind)} | {timestamp_ns(decoded.timestamp)}
            self.require(len(times) == 1, f"{topic}: annotations of one message have different times")
            self.annotation_times.setdefault(topic.replace("/annotations", "/image"), set()).update(times)
        if topic.endswith("/landmark") and not self.image_times:
            self.landmark_seen_before_images = True

    def check_records(self):
        """Header, metadata and attachments, read record by record."""
        with open(self.path, "rb") as stream:
            records = list(StreamReader(stream, validate_crcs=True).records)
        metadata = {record.name: record.metadata for record in records if isinstance(record, Metadata)}
        attachments = [record.name for record in records if isinstance(record, Attachment)]
        return metadata, attachments

    def check_summary(self):
        """The summary as a seeking reader sees it, against what was counted."""
        with open(self.path, "rb") as stream:
            reader = SeekingReader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
            header, summary = reader.get_header(), reader.get_summary()
            self.require(header.profile == "", f"profile is {header.profile!r}")
            self.require(re.fullmatch(r"waymark/\S+ mcap/\S+", header.library), f"library is {header.library!r}")
            self.require(summary is not None and summary.statistics is not None, "there is no summary")
            by_topic = Counter()
            for channel_id, count in summary.statistics.channel_message_counts.items():
                by_topic[summary.channels[channel_id].topic] += count
            self.require(+by_topic == +self.counts, f"statistics {dict(by_topic)} are not {dict(self.counts)}")
            sought = sum(1 for _ in reader.iter_messages())
            self.require(sought == self.counts.total(), f"{sought} messages through the index, not {self.counts.total()}")
            return header.library, summary.statistics

    def check_accounts(self, accounts):
        """offered = stored + lost + unrecorded, and stored + repeated is what is in the file."""
        lost = {}
        for topic, entry in accounts.items():
            account = json.loads(entry)
            lost_here = account["lost_in_queue"] + account["lost_on_disk"]
            settled = account["stored"] + lost_here + account["unrecorded"]
            self.require(account["offered"] == settled, f"{topic}: {account} does not add up")
            stored = account["stored"] + account["repeated"]
            self.require(stored == self.counts[topic], f"{topic}: {self.counts[topic]} messages, accounts say {stored}")
            if lost_here:
                lost[topic] = lost_here
        unaccounted = set(self.counts) - set(accounts)
        self.require(not unaccounted, f"topics without account: {sorted(unaccounted)}")
        return lost

    def check_times(self):
        """Each annotation belongs to an image, unless that image was left to the file before or was lost."""
        for topic, times in self.annotation_times.items():
            images = self.image_times.get(topic, set())
            within = {time for time in times if images and min(images) <= time <= max(images)}
            missing = len(within - images)
            self.require(missing * 20 <= len(within), f"{topic}: {missing} of {len(within)} annotations have no image")

    def check(self):
        self.read_messages()
        metadata, attachments = self.check_records()
        library, statistics = self.check_summary()
        accounts = metadata.get("waymark.accounts")
        lost = self.check_accounts(accounts) if accounts is not None else None
        self.check_times()
        # A series may begin before the leader was heard; each later file repeats the landmarks at its head.
        begins_series = "-0001." in self.path.name
        if self.image_times and not begins_series and any(topic.endswith("/landmark") for topic in self.counts):
            self.require(self.landmark_seen_before_images or accounts is None, "no landmark before the first image")
        span_s = (statistics.message_end_time - statistics.message_start_time) / NS_PER_S
        return {
            "path": str(self.path),
            "library": library,
            "span_s": round(span_s, 3),
            "messages": dict(sorted(self.counts.items())),
            "metadata": sorted(metadata),
            "attachments": attachments,
            "lost": lost,
            "problems": self.problems,
        }


def main(paths):
    if not paths:
        print(__doc__, file=sys.stderr)
        return 2
    status = 0
    for path in paths:
        recording = Recording(Path(path))
        try:
            result = recording.check()
        except Exception as error:  # whatever a strict reader raises is the finding
            result = {"path": path, "problems": [*recording.problems, f"{type(error).__name__}: {error}"], "lost": None}
        print(json.dumps(result))
        if result["problems"]:
            status = 1
        elif result["lost"] and status == 0:
            status = 3
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
