"""What learned planners of the arena suite share: encoders of scan and waypoint,
policies and the scaling of actions.
"""

from arena_core import Register, hookimpl


@hookimpl
def register_observation_encoders(register: Register) -> None:
    """Offer the encoders."""
    register("rosnav", "arena_policies.rosnav:RosnavEncoder")
    register("rosnav_sectors", "arena_policies.rosnav_sectors:RosnavSectorsEncoder")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_policies.conf"
