"""ROS maps and built-in worlds for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_worlds(register: Register) -> None:
    """Offer maps and world files, BARN's worlds, the built-in halls and the generators."""
    register("ros_map", "arena_worlds.ros_map:RosMap")
    register("file", "arena_worlds.file_world:FileWorld")
    register("scenario_map", "arena_worlds.scenario_map:ScenarioMap")
    register("barn", "arena_worlds.barn:BarnWorlds")
    register("dynabarn", "arena_worlds.dynabarn:DynabarnWorlds")
    register("empty", "arena_worlds.empty:EmptyRoom")
    register("lab", "arena_worlds.lab:Lab")
    register("warehouse", "arena_worlds.warehouse:Warehouse")
    register("indoor", "arena_worlds.indoor:Indoor")
    register("outdoor", "arena_worlds.outdoor:Outdoor")
    register("rooms", "arena_worlds.rooms:Rooms")
    register("cellular", "arena_worlds.cellular:Cellular")
    register("mixed", "arena_worlds.mixed:MixedWorlds")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena world``."""
    register("world", "arena_worlds.command:WorldCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_worlds.conf"
