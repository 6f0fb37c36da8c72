"""Fast, batched 2-D simulator of the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_simulators(register: Register) -> None:
    """Offer the 2-D simulator."""
    register("sim2d", "arena_sim2d.simulator:Sim2d")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_sim2d.conf"
