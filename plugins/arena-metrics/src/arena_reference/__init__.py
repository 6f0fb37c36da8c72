"""How an episode compares with what could have been: with the best way, and with no robot at all."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the planners that see the truth."""
    register("clairvoyant", "arena_reference.planner:Clairvoyant")
    register("sighted", "arena_reference.planner:Sighted")


@hookimpl
def register_references(register: Register) -> None:
    """Offer to certify what could have been done in a run's problems."""
    register("clairvoyant", "arena_reference.certifying:ClairvoyantReference")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena reference``, ``arena explain`` and ``arena cost``."""
    register("reference", "arena_reference.command:ReferenceCommand")
    register("explain", "arena_reference.explain_command:ExplainCommand")
    register("cost", "arena_reference.cost_command:CostCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_reference.conf"
