"""What a record holds, as a digest: two episodes are the same, bit for bit, where theirs are equal."""

from __future__ import annotations

import json
from hashlib import blake2b

import numpy as np

from arena_core.values.episode import DRIVER, EpisodeRecord

# columns that say which code and configuration made a record: neither is what happened
WHICH_CODE = ("code", "config_hash")
GIVEN = ("route_points", "route_offsets")  # what the problem was, which older records do not hold


def record_digest(record: EpisodeRecord) -> str:
    """Return a digest, 32 hexadecimal digits, of a record's arrays and of what its meta says happened.

    Wall times do not count, nor what names code and configuration: equal drives of other code have equal digests.
    """
    digest = blake2b(json.dumps(_recorded_facts(record), sort_keys=True).encode(), digest_size=16)
    for name in sorted(record.arrays.keys() - set(GIVEN)):
        array = np.ascontiguousarray(record.arrays[name])
        digest.update(f"\0{name} {array.dtype.str} {array.shape}\0".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def _recorded_facts(record: EpisodeRecord) -> dict[str, object]:
    columns = {key: value for key, value in record.meta["columns"].items() if key not in WHICH_CODE}
    # which member drove says nothing of where
    events = [event for event in record.meta["events"] if event["kind"] != DRIVER]
    return {
        **{key: value for key, value in record.meta.items() if key != "config"},
        "columns": columns,
        "events": events,
    }
