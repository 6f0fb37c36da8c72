"""NAVREP, a local planner that learns with a world model."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer NAVREP."""
    register("navrep", "arena_navrep.planner:Navrep")


@hookimpl
def register_observation_encoders(register: Register) -> None:
    """Offer what the controller sees: the world model's code and memory."""
    register("navrep", "arena_navrep.encoder:NavrepEncoder")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena navrep``."""
    register("navrep", "arena_navrep.navrep_command:NavrepCommand")


@hookimpl
def register_policies(register: Register) -> None:
    """Offer its policies, with memory and on vision alone."""
    register("navrep/navrep", "pkg://arena_navrep/policies")
    register("navrep/navrep_v_only", "pkg://arena_navrep/policies_v_only")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_navrep.conf"
