"""AIO, a learned switch between local planners."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer AIO."""
    register("aio", "arena_aio.planner:Aio")


@hookimpl
def register_observation_encoders(register: Register) -> None:
    """Offer what the switch sees."""
    register("aio", "arena_aio.encoder:AioEncoder")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena choices``."""
    register("choices", "arena_aio.choices_command:ChoicesCommand")


@hookimpl
def register_policies(register: Register) -> None:
    """Offer the policies of its switch."""
    register("aio/aio", "pkg://arena_aio/policies")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_aio.conf"
