"""What a training that is interrupted leaves: a policy of what it has learned, and a line that says what is kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from arena_core.files import read_json
from arena_gym.training.checkpoint import load_checkpoint
from arena_gym.training.export import Actor, round_weights
from arena_gym.training.imitation import IMITATED_FILE, load_imitation
from arena_gym.training.learner import Learner
from arena_gym.training.trainer import CHECKPOINT

GOES_ON = "resume=true (with the same words) goes on from there"
Write = Callable[[Mapping[str, Any]], None]


@contextmanager
def save_on_interrupt(learner: Learner, folder: Path, write: Write) -> Iterator[None]:
    """Have Ctrl-C ``write`` the policy of what is kept, with what its card tells of it, and say what that is."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        interrupt.add_note(_save_unfinished(learner, folder, write))
        raise


def _save_unfinished(learner: Learner, folder: Path, write: Write) -> str:
    found = _load_best_weights(learner, folder) or _load_imitated_policy(learner, folder)
    if found is None:
        return f"nothing was learned as yet; resume=true (with the same words) begins again in {folder}"
    kept, told = found
    policy = folder / "policy.onnx"
    if is_tested(policy):
        return f"{kept}, and {policy} as it was; {GOES_ON}"
    print(f"interrupted: writing {policy} (again: at once, without it) ...", flush=True)
    round_weights(Actor(learner.policy))
    write(told)
    return f"{kept}, and {policy}, untested; {GOES_ON}"


def _load_best_weights(learner: Learner, folder: Path) -> tuple[str, dict[str, Any]] | None:
    """Give a learner the best weights of a checkpoint, or its last where none was validated; say
    which, for the user and for a card.
    """
    if not (folder / CHECKPOINT).exists():
        return None
    progress, best = load_checkpoint(folder / CHECKPOINT, learner)
    if best is not None:
        learner.policy.load_state_dict(best)
    told = {"steps": learner.num_timesteps, "curve": progress["curve"], "weights": "last" if best is None else "best"}
    kept = f"{folder / CHECKPOINT} is kept, after {learner.num_timesteps} steps"
    return kept, {**told, "choice": progress["choice"], "score": None}


def _load_imitated_policy(learner: Learner, folder: Path) -> tuple[str, dict[str, Any]] | None:
    if not (folder / IMITATED_FILE).exists():
        return None
    lessons = load_imitation(folder, Actor(learner.policy))
    kept = f"{folder / IMITATED_FILE} is kept, after {lessons} lesson{'s' * (lessons > 1)}"
    return kept, {"steps": 0, "curve": [], "weights": "last", "choice": None, "score": None}


def is_tested(policy: Path) -> bool:
    """Return whether a policy is there whose card has the score of a test: of a training that had ended."""
    card = policy.with_suffix(".json")
    if not (policy.exists() and card.exists()):
        return False
    content = read_json(card, "a card that `arena train` wrote")
    training = content.get("training") if isinstance(content, dict) else None
    return isinstance(training, dict) and training.get("score") is not None
