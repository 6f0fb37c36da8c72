"""Seeds of training, apart from those of evaluation."""

from arena_core import ConfigurationError

FIRST_TRAINING_SEED = 2**32
_WORLDS = 2**16  # seeds that belong to one training seed, one a world


def training_seed(seed: int, world: int = 0) -> int:
    """Return the seed of a world of training, which no evaluation uses."""
    assert seed >= 0
    assert 0 <= world < _WORLDS
    return FIRST_TRAINING_SEED + seed * _WORLDS + world


def check_evaluation_seed(seed: int) -> int:
    """Return the seed of an evaluation; raise ConfigurationError if training may have seen its problems."""
    if not 0 <= seed < FIRST_TRAINING_SEED:
        raise ConfigurationError(
            f"evaluation seed is {seed}; allowed: 0 .. {FIRST_TRAINING_SEED - 1}, "
            "the seeds from there on are for training"
        )
    return seed


def check_unseen_seed(seed: int, trained: int, name: str) -> int:
    """Return the seed of an evaluation, called ``name``; raise ConfigurationError if training on
    ``trained`` may have seen it.
    """
    if seed == trained:
        raise ConfigurationError(f"{name} is {seed}; allowed: any other than environment.seed, which is for training")
    return check_evaluation_seed(seed)
