"""``arena navrep``: from roll-outs to a world model, stage by stage."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, complete_overrides, read_words
from arena_core.hosting import require_extra
from arena_core.parameters import Bounds, NonNegativeInt

STAGES = ("record", "vision", "memory")
NEEDS = {"vision": "rollouts/config.json", "memory": "vision.onnx"}  # what the stage before has written
USAGE = "arena navrep record|vision|memory|all robot=NAME [seed=0] [device=cpu] [out=DIR] [resume=true] [KEY=VALUE ...]"
EVIDENCE = "arena navrep evidence policy=FILE [out=DIR] [episodes=200] [seed=1000]"
NEEDED = ("arena_gym", "torch", "stable_baselines3", "onnx", "onnxscript")
OWN = ("out", "resume")
PAIRS = Annotated[int, Bounds(low=2)]  # of episodes that two are compared by


class NavrepCommand(Command):
    """Train the world model that NAVREP's controller is trained on, or show what it is worth."""

    help: ClassVar[str] = "train NAVREP's world model: arena navrep record|vision|memory|all robot=jackal"
    kept: ClassVar[str] = (
        "files of roll-outs and epochs that are over are kept, resume=true (with the same words) goes on from there"
    )

    def run(self, arguments: Sequence[str]) -> int:
        """Run one stage, or all; write roll-outs, networks, cards and curves to a folder."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}\n       {EVIDENCE}")
            return 0
        stage, *words = arguments
        if stage == "evidence":
            return _show_evidence(words)
        if stage not in (*STAGES, "all"):
            raise ConfigurationError(f"stage is {stage}; allowed: {', '.join(STAGES)}, all, evidence")
        require_extra("arena navrep", NEEDED, "arena-navrep[train]")
        given = read_words(USAGE, words, keys=OWN, overrides=None)
        resume = given.value("resume", bool, False)
        from arena_gym.building import compose_training

        config = compose_training(None, given.overrides, "world_model")
        folder = Path(given.keys.get("out", f"trainings/world_model_{config['robot']['name']}"))
        for chosen in STAGES if stage == "all" else (stage,):
            _run_stage(chosen, config, folder, resume=resume)
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the stages, then overrides of the world model's training."""
        return complete_overrides(words, word, primary="world_model") if words else (*STAGES, "all", "evidence")


def _run_stage(stage: str, config: Mapping[str, Any], folder: Path, *, resume: bool) -> None:
    """Run a stage in a folder of its own; raise ConfigurationError where that is another training's."""
    if stage in NEEDS and not (folder / NEEDS[stage]).exists():
        raise ConfigurationError(
            f"{folder} has no {NEEDS[stage]}; `arena navrep {STAGES[STAGES.index(stage) - 1]} ...` makes it"
        )
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
        folder / ("rollouts" if stage == "record" else stage),
        {k: v for k, v in config.items() if k not in later},
        resume=resume,
    )
    if resume and (folder / f"{stage}.onnx").exists():
        print(f"{stage}: {folder / stage}.onnx is there")
        return
    own[stage](config, folder)
    if stage != "record":
        print(f"{stage}: {folder / stage}.onnx")


def _show_evidence(words: Sequence[str]) -> int:
    given = read_words(EVIDENCE, words, keys=("policy", "out", "episodes", "seed"))
    if not given.keys.keys() & {"policy", "out"}:
        raise ConfigurationError(f"policy and out are missing; allowed: {EVIDENCE}")
    episodes, seed = given.value("episodes", PAIRS, 200), given.value("seed", NonNegativeInt, 1000)
    require_extra("arena navrep evidence", ["arena_gym"], "arena-navrep[train]")
    from arena_navrep.evidence import memory_ablation, prediction_report

    if "out" in given.keys:
        print(prediction_report(Path(given.keys["out"])))
    if "policy" in given.keys:
        print(memory_ablation(given.keys["policy"], episodes, seed))
    return 0
