"""Random and scenario tasks for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_task_modes(register: Register) -> None:
    """Offer random problems, and problems from a file."""
    register("random", "arena_tasks.random_task:RandomTask")
    register("scenario", "arena_tasks.scenario_task:ScenarioTask")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_tasks.conf"
