"""``arena train``: from a recipe to a policy with its card."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, complete_overrides, key_value, read_words
from arena_core.files import options_of
from arena_core.hosting import load_registry, require_extra
from arena_gym.api import NEEDED, train_config
from arena_gym.building import compose_training

USAGE = (
    "arena train planner=NAME robot=NAME [seed=0 or seed=0,1,2] [total_steps=N] [device=cpu] [out=DIR] "
    "[resume=true or resume=force] [test=false] "
    "[KEY=VALUE ...]"
)
OWN = ("planner", "seed", "out", "resume", "test")
# go on with a folder; by other code, too
RESUME = ("false", "true", "force")


class TrainCommand(Command):
    """Train a learned planner for a robot."""

    help: ClassVar[str] = "train a learned planner: arena train planner=rosnav robot=jackal"
    checks: ClassVar[str] = "recipe"

    def run(self, arguments: Sequence[str]) -> int:
        """Train, and write policy, card, curve and logs to a folder; one training after the other
        where there are several seeds.
        """
        if any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        require_extra("arena train", NEEDED, "arena-gym[train]")
        words = read_words(USAGE, arguments, keys=OWN, overrides=None)
        resume = words.keys.get("resume", "false")
        if resume not in RESUME:
            raise ConfigurationError(f"resume is {resume}; allowed: {', '.join(RESUME)}")
        tests = words.keys.get("test", "true")
        if tests not in ("true", "false"):
            raise ConfigurationError(f"test is {tests}; allowed: true, false")
        untested = ["training.test.episodes=0"] if tests == "false" else []
        seeds = words.keys["seed"].split(",") if "seed" in words.keys else [None]
        if len(set(seeds)) < len(seeds) or not all(seed is None or seed.isdecimal() for seed in seeds):
            raise ConfigurationError(
                f"seed is {words.keys['seed']}; allowed: a whole number, or several, each once: seed=0,1,2"
            )
        configs = [
            compose_training(
                words.keys.get("planner"),
                [*words.overrides, *untested, *([f"seed={seed}"] if seed is not None else [])],
            )
            for seed in seeds
        ]
        for config in configs:
            robot = _robot_name(words.overrides, config)
            folder = Path(words.keys.get("out", f"trainings/{config['planner']}_{robot}_{config['seed']}"))
            if len(configs) > 1 and "out" in words.keys:
                folder = folder.with_name(f"{folder.name}_{config['seed']}")
            if len(configs) > 1:
                print(f"seed {config['seed']}: {folder}", flush=True)
            train_config(config, folder, robot, resume=resume != "false", force=resume == "force")
        return 0

    def check(self, name: str, overrides: Sequence[str]) -> int:
        """Print what a recipe's rewards pay on each robot, or on the one that the overrides choose; return 2 where
        they pay nobody.
        """
        require_extra("arena check recipe", NEEDED, "arena-gym[train]")
        registry = load_registry()
        known = options_of("recipe", registry.manager)
        if name not in known:
            raise ConfigurationError(f"recipe is {name or 'not named'}; allowed: {', '.join(known)}")
        given = [body for body in (dict(map(key_value, overrides)).get("robot"),) if body is not None]
        others = [word for word in overrides if key_value(word)[0] != "robot"]
        robots = given or options_of("robot", registry.manager)
        return max(_check_recipe(name, body, others, must=bool(given)) for body in robots)

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the planners that have a recipe, and overrides."""
        if word.startswith("planner="):
            return [f"planner={recipe}" for recipe in options_of("recipe", load_registry().manager)]
        return [
            *(f"{key}=" for key in OWN),
            "resume=true",
            "resume=force",
            "test=false",
            *complete_overrides(words, word, primary="train"),
        ]


def _check_recipe(name: str, robot: str, overrides: Sequence[str], *, must: bool) -> int:
    """Print what a recipe's rewards pay on a robot; one that it cannot be built for is passed over, unless it
    ``must``.
    """
    from arena_gym.training.session import describe_reward

    said = f"recipe={name} on {robot}"
    try:
        config = compose_training(name, [f"robot={robot}", *overrides])
        if config["trainer"] is not None or config.get("switch") is not None:
            print(f"-- {said}: not checked, it learns no velocities from rewards")
            return 0
        way, settings = describe_reward(config)
    except ConfigurationError as error:
        if must:
            raise
        print(f"-- {said}: {error}")
        return 0
    refusal = way.refusal()
    if refusal is None:
        print(f"ok {said}: {way.describe()}")
    elif settings.allow_unpaid or not settings.total_steps:
        print(f"-- {said} {'allows it' if settings.allow_unpaid else 'has lessons alone'}: {refusal}")
    else:
        print(f"BROKEN {said}: {refusal}")
        return 2
    return 0


def _robot_name(overrides: Sequence[str], config: Mapping[str, Any]) -> str:
    """Return the robot by the name of its file, which may derive from another's."""
    chosen = dict(map(key_value, overrides)).get("robot", "")
    return chosen if re.fullmatch(r"[\w-]+", chosen) else str(config["robot"]["name"])
