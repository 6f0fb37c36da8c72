"""GRING, a local planner learned by reinforcement that follows waypoints and stops for people."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer GRING."""
    register("gring", "arena_gring.planner:Gring")


@hookimpl
def register_observation_encoders(register: Register) -> None:
    """Offer what GRING sees: the nearest returns, now and before, and waypoints ahead."""
    register("gring", "arena_gring.encoder:GringEncoder")


@hookimpl
def register_rewards(register: Register) -> None:
    """Offer what it is trained by."""
    register("gring", "arena_gring.reward:GringReward")


@hookimpl
def register_policies(register: Register) -> None:
    """Offer its policies."""
    register("gring/gring", "pkg://arena_gring/policies")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_gring.conf"
