"""Records in the forms of other programs: ``arena export``."""

from arena_core import Register, hookimpl


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena export``."""
    register("export", "arena_export.command:ExportCommand")


@hookimpl
def register_exports(register: Register) -> None:
    """Offer the trajectories of social navigation surveys, and recordings of Rerun."""
    register("socnav.json", "arena_export.socnav:SocNavExport")
    register("rerun", "arena_export.rerun:RerunExport")
