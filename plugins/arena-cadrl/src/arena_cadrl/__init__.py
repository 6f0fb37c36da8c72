"""CADRL and SARL: value networks over tracked people, for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer CADRL and SARL."""
    register("cadrl", "arena_cadrl.planner:Cadrl")
    register("sarl", "arena_cadrl.planner:Sarl")


@hookimpl
def register_rewards(register: Register) -> None:
    """Offer the reward that the values are of."""
    register("cadrl", "arena_cadrl.reward:CadrlReward")


@hookimpl
def register_trainers(register: Register) -> None:
    """Offer the training of value networks."""
    register("value_network", "arena_cadrl.training.trainer:ValueTrainer")


@hookimpl
def register_policies(register: Register) -> None:
    """Offer their policies."""
    register("cadrl/cadrl", "pkg://arena_cadrl/policies")
    register("sarl/sarl", "pkg://arena_cadrl/policies_sarl")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_cadrl.conf"
