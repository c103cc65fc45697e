"""A querier that asks and asks and reads nothing: its session stops taking what arrives, and its connection fills up.

    python stalled_querier.py ENDPOINT
"""

import itertools
import sys
import time

import zenoh
from zenoh.handlers import FifoChannel


def main() -> None:
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{sys.argv[1]}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    session = zenoh.open(config)
    # The first sample fills the channel; the next one blocks the session's receiving thread for good.
    unread: list[object] = [session.declare_subscriber("waymark/v1/**", FifoChannel(1))]
    for asked in itertools.count(1):
        # Every second question goes to everybody who is present, also to a follower that does not answer.
        key = "waymark/v1/**" if asked % 2 else "@waymark/v1/*/*/*/*"
        replies = session.get(key, FifoChannel(1), target=zenoh.QueryTarget.ALL)
        if asked < 1000:
            unread.append(replies)
        time.sleep(0.01)


if __name__ == "__main__":
    main()
