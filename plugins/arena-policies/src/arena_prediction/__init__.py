"""The predictor that has learned where people will be, how it is trained, and how predictors are measured."""

from arena_core import Register, hookimpl


@hookimpl
def register_predictors(register: Register) -> None:
    """Offer the network."""
    register("learned", "arena_prediction.predictor:LearnedPredictor")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena predict``."""
    register("predict", "arena_prediction.predict_command:PredictCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_prediction.conf"
