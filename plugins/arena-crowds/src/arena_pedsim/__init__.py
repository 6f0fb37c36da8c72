"""Social-force crowd for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_pedestrian_models(register: Register) -> None:
    """Offer the social-force crowd."""
    register("social_force", "arena_pedsim.model:SocialForceModel")


@hookimpl
def register_predictors(register: Register) -> None:
    """Offer the forces of that crowd as what people will do."""
    register("social_force", "arena_pedsim.prediction.predictor:SocialForcePredictor")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_pedsim.conf"
