"""ROS maps and built-in worlds for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_worlds(register: Register) -> None:
    """Offer maps and world files, BARN's worlds, the built-in halls, the generators, and what furnishes worlds."""
    register("ros_map", "arena_worlds.formats.ros_map:RosMap")
    register("file", "arena_worlds.formats.file_world:FileWorld")
    register("scenario_map", "arena_worlds.formats.scenario_map:ScenarioMap")
    register("barn", "arena_worlds.formats.barn:BarnWorlds")
    register("dynabarn", "arena_worlds.generators.dynabarn:DynabarnWorlds")
    register("empty", "arena_worlds.generators.empty:EmptyRoom")
    register("door", "arena_worlds.generators.door:Door")
    register("lab", "arena_worlds.generators.lab:Lab")
    register("warehouse", "arena_worlds.generators.warehouse:Warehouse")
    register("indoor", "arena_worlds.generators.indoor:Indoor")
    register("outdoor", "arena_worlds.generators.outdoor:Outdoor")
    register("rooms", "arena_worlds.generators.rooms:Rooms")
    register("cellular", "arena_worlds.generators.cellular:Cellular")
    register("furnished", "arena_worlds.generators.furnished:FurnishedWorlds")
    register("mixed", "arena_worlds.generators.mixed:MixedWorlds")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena world``."""
    register("world", "arena_worlds.commands.command:WorldCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_worlds.conf"
