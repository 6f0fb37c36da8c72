"""An experiment is composed and checked by the core before it starts, and shown as one would type it."""

from __future__ import annotations

import pytest

from arena_core import ConfigurationError
from arena_studio.experiments.composing import MOST_JOBS, compose_experiment, shell_command


def test_choices_and_values_become_words() -> None:
    found = compose_experiment({"planner": ["pure_pursuit"]}, {"episodes": "3", "task.time_limit": "20"}, "seed=4")
    assert found.words == ("planner=pure_pursuit", "episodes=3", "task.time_limit=20", "seed=4")
    assert (found.jobs, found.episodes, found.is_sweep) == (1, 3, False)
    assert found.values["planner.name"] == "pure_pursuit"
    assert found.values["resume"] == "false"
    words = found.command("outputs/a b")
    assert words == ["run", *found.words, "hydra.run.dir='outputs/a b'"]
    assert shell_command(words[:2]) == "arena run planner=pure_pursuit"


def test_several_options_and_values_with_commas_make_a_sweep() -> None:
    found = compose_experiment(
        {"planner": ["pure_pursuit", "dwa"], "metrics": ["si", "barn"]}, {"task.pedestrians": "2, 4"}, ""
    )
    assert found.words == ("planner=pure_pursuit,dwa", "metrics=[si,barn]", "task.pedestrians=2,4")
    assert (found.jobs, found.episodes) == (4, 60)
    assert found.command("m")[:2] == ["run", "-m"]
    assert found.command("m")[-1] == "hydra.sweep.dir=m"


@pytest.mark.parametrize(
    ("choices", "values", "more", "said"),
    [
        ({"planner": ["dvva"]}, {}, "", "unknown planner 'dvva'"),
        ({}, {"episodes": "0"}, "", "episodes is 0; allowed: >= 1"),
        ({}, {"task.pedestrians": "2,-1"}, "", "task.pedestrians is -1"),
        ({}, {"timing.mode": "lately"}, "", "timing.mode is 'lately'; allowed: one of ideal, latency, measured"),
        ({}, {"planner.limit": "1"}, "", "did you mean limits"),
        ({}, {"a b": "1"}, "", "is no key"),
        ({"planner": ["a b"]}, {}, "", "is no name"),
        ({}, {}, "hydra.run.dir=/tmp", "is Hydra's own"),
        ({}, {}, "hydra/launcher=basic", "is Hydra's own"),
        ({}, {}, "'open", "cannot be read"),
        ({}, {}, "planner", "is no override"),
        ({}, {}, "--cfg=job", "is no override"),
        ({}, {"seed": ",".join(map(str, range(40)))}, "", "allowed: up to"),
        ({}, {"seed": "1," * MOST_JOBS}, "", f"allowed: up to {MOST_JOBS}"),
    ],
)
def test_wrong_experiment_is_refused_in_one_line(
    choices: dict[str, list[str]], values: dict[str, str], more: str, said: str
) -> None:
    with pytest.raises(ConfigurationError) as refused:
        compose_experiment(choices, values, more)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("text", ["it's a name", "a;rm -rf ~", "$(date)", "a\\'b", "größe", "a=b", "x: y"])
def test_text_reaches_the_component_as_it_was_typed(text: str) -> None:
    with pytest.raises(ConfigurationError) as refused:
        compose_experiment({}, {"task.pedestrians": text}, "")
    assert str(refused.value) == f"task.pedestrians is {text!r}; allowed: a whole number"
