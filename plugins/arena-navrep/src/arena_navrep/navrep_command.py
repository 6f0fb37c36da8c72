"""``arena navrep``: from roll-outs to a world model, stage by stage."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, ClassVar

from arena_core import Command, ConfigurationError, compose, plain

STAGES = ("record", "vision", "memory")
NEEDS = {"vision": "rollouts/config.json", "memory": "vision.onnx"}  # what the stage before has written
USAGE = (
    "usage: arena navrep record|vision|memory|all robot=NAME [seed=0] [device=cpu] [out=DIR] [resume=true] [KEY=VALUE ...]\n"
    "       arena navrep evidence policy=FILE [out=DIR] [episodes=200] [seed=1000]"
)
NEEDED = ("arena_gym", "torch", "stable_baselines3", "onnx", "onnxscript")
OWN = ("out=", "resume=")


class NavrepCommand(Command):
    """Train the world model that NAVREP's controller is trained on, or show what it is worth."""

    help: ClassVar[str] = "train NAVREP's world model: arena navrep record|vision|memory|all robot=jackal"

    def run(self, arguments: Sequence[str]) -> int:
        """Run one stage, or all; write roll-outs, networks, cards and curves to a folder."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(USAGE)
            return 0
        stage, *words = arguments
        if stage == "evidence":
            return _show_evidence(words)
        if stage not in (*STAGES, "all"):
            raise ConfigurationError(f"stage is {stage}; allowed: {', '.join(STAGES)}, all, evidence")
        _check_installed(NEEDED)
        given = dict(word.split("=", 1) for word in words if word.startswith(OWN))
        config = plain(compose([word for word in words if not word.startswith(OWN)], "world_model"))
        folder = Path(given.get("out") or f"trainings/world_model_{config['robot']['name']}")
        for chosen in STAGES if stage == "all" else (stage,):
            _run_stage(chosen, config, folder, given.get("resume", "false"))
        return 0


def _check_installed(names: Sequence[str]) -> None:
    missing = [name for name in names if find_spec(name) is None]
    if missing:
        raise ConfigurationError(f"arena navrep needs {', '.join(missing)}; install the extra arena-navrep[train]")


def _run_stage(stage: str, config: Mapping[str, Any], folder: Path, resume: str) -> None:
    """Run a stage in a folder of its own; raise ConfigurationError where that is another training's."""
    if resume not in ("true", "false"):
        raise ConfigurationError(f"resume is {resume}; allowed: true, false")
    if stage in NEEDS and not (folder / NEEDS[stage]).exists():
        raise ConfigurationError(f"{folder} has no {NEEDS[stage]}; `arena navrep {STAGES[STAGES.index(stage) - 1]} ...` makes it")
    from arena_gym.training.folder import open_folder
    from arena_navrep.training import stages

    stages.check_settings(config)
    own: dict[str, Callable[[Mapping[str, Any], Path], None]] = {
        "record": stages.record_rollouts,
        "vision": stages.fit_vision,
        "memory": stages.fit_memory,
    }
    later = STAGES[STAGES.index(stage) + 1 :]
    open_folder(
        folder / ("rollouts" if stage == "record" else stage), {k: v for k, v in config.items() if k not in later}, resume == "true"
    )
    if resume == "true" and (folder / f"{stage}.onnx").exists():
        print(f"{stage}: {folder / stage}.onnx is there")
        return
    own[stage](config, folder)
    if stage != "record":
        print(f"{stage}: {folder / stage}.onnx")


def _show_evidence(words: Sequence[str]) -> int:
    given = dict(word.partition("=")[::2] for word in words)
    wrong = [word for word in words if word.partition("=")[0] not in ("policy", "out", "episodes", "seed") or not word.partition("=")[2]]
    if wrong or not given.keys() & {"policy", "out"}:
        raise ConfigurationError(f"arena navrep evidence: {', '.join(wrong) or 'nothing given'}; allowed: policy=, out=, episodes=, seed=")
    episodes, seed = _number(given, "episodes", "200", least=2), _number(given, "seed", "1000", least=0)
    _check_installed(("arena_gym",))
    from arena_navrep.evidence import foresight, worth_of_memory

    if "out" in given:
        print(foresight(Path(given["out"])))
    if "policy" in given:
        print(worth_of_memory(given["policy"], episodes, seed))
    return 0


def _number(given: Mapping[str, str], name: str, default: str, least: int) -> int:
    value = given.get(name, default)
    if not (value.isascii() and value.isdecimal() and int(value) >= least):
        raise ConfigurationError(f"{name} is {value}; allowed: a whole number from {least} on")
    return int(value)
