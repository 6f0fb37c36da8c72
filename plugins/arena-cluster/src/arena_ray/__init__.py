"""Episodes on a Ray cluster. Ray is imported when a run begins."""

from arena_core import Register, hookimpl


@hookimpl
def register_executors(register: Register) -> None:
    """Offer the machines of a Ray cluster."""
    register("ray", "arena_ray.executor:RayExecutor")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_ray.conf"
