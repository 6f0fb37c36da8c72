import math
import pickle
import sys
from collections import Counter

import numpy as np
import pytest

from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry
from arena_core.runs.folders.kept_rows import KeptRow
from arena_core.runs.jobs.benchmark import build_metrics
from arena_core.runs.jobs.rows import COLUMNS, metric_columns, write_episodes

EPISODES = 100


def row(episode, packs):
    """Return a row as it comes from a worker: nothing of it is shared with another row's."""
    texts = {name: f"what {name} is in all of them" for name in COLUMNS}
    texts |= {"scenario": f"random/{episode}", "episode": episode, "seed": 0, "stage": None, "n_pedestrians": 10}
    numbers = {name: episode + 0.1 * k for k, name in enumerate(metric_columns(packs))}
    return pickle.loads(pickle.dumps(texts | numbers | {"undefined": math.nan}))


@pytest.fixture(scope="module")
def packs():
    return build_metrics(to_plain(compose(["planner=pure_pursuit", "robot=jackal"])), load_registry())


def test_a_kept_row_is_the_row_bit_for_bit(packs):
    given = row(3, packs) | {"zero": -0.0, "flag": True, "numpy": np.float64(0.1)}
    kept = KeptRow(given)
    assert list(kept) == list(given)
    assert [(type(value), repr(value)) for value in kept.values()] == [
        (type(value), repr(value)) for value in given.values()
    ]
    assert kept.get("nobody") is None
    with pytest.raises(KeyError):
        kept["nobody"]


def test_the_table_of_kept_rows_is_that_of_the_rows(packs, tmp_path):
    rows = [{key: value for key, value in row(k, packs).items() if key != "undefined"} for k in range(3)]
    for name, kept in (("one", rows), ("other", [KeptRow(given) for given in rows])):
        (tmp_path / name).mkdir()
        write_episodes(tmp_path / name, kept, packs)
    assert (tmp_path / "one" / "episodes.csv").read_bytes() == (tmp_path / "other" / "episodes.csv").read_bytes()


def test_an_episode_keeps_less_than_a_thousand_bytes(packs):
    kept = [KeptRow(row(k, packs)) for k in range(EPISODES)]
    rows_of = Counter(id(value) for one in kept for value in one._others)
    own = [value for one in kept for value in one._others if rows_of[id(value)] == 1]
    parts = [part for one in kept for part in (one, one._numbers, one._others)]
    assert len({id(one._layout) for one in kept}) == 1
    assert sum(map(sys.getsizeof, [*parts, *own])) / EPISODES < 1000.0
