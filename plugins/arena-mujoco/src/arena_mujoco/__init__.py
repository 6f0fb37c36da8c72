"""3-D physics simulator on MuJoCo, and pictures of episodes in 3-D."""

from arena_core import Register, hookimpl


@hookimpl
def register_simulators(register: Register) -> None:
    """Offer the 3-D simulator."""
    register("mujoco", "arena_mujoco.simulator:MujocoSimulator")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena render``."""
    register("render", "arena_mujoco.pictures.command:RenderCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_mujoco.conf"
