"""More crowds for the arena suite, and how any crowd is validated."""

from arena_core import Register, hookimpl


@hookimpl
def register_pedestrian_models(register: Register) -> None:
    """Offer no one, people as ORCA agents, recorded people, and what moves by a timetable."""
    register("none", "arena_crowds.nobody:Nobody")
    register("orca", "arena_crowds.orca.crowd:OrcaCrowd")
    register("replay", "arena_crowds.replay.crowd:ReplayedCrowd")
    register("timetable", "arena_crowds.replay.timetable:TimetableCrowd")


@hookimpl
def register_task_modes(register: Register) -> None:
    """Offer robots that take the place of recorded people."""
    register("replace", "arena_crowds.replay.replace_task:ReplaceTask")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer the validation of crowd models."""
    register("crowd", "arena_crowds.validation.command:CrowdCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_crowds.conf"
