"""Fast, batched 2-D simulator of the arena suite."""

from arena_core import Register, hookimpl
from arena_kernels.ready import choose_target


@hookimpl
def register_simulators(register: Register) -> None:
    """Offer the 2-D simulator."""
    choose_target()  # before anything imports numba
    register("sim2d", "arena_sim2d.simulator:Sim2d")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena compile``."""
    register("compile", "arena_sim2d.compile_command:CompileCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_sim2d.conf"
