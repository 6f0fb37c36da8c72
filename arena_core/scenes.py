"""The solids of a world: furniture, walls, doors, obstacles as polygons and prisms."""

from arena_core.config.furniture import furniture_kind
from arena_core.values.doors import Door, close_doors, is_open
from arena_core.values.furniture import FurnitureKind, add_furniture, furniture_of, furniture_outlines, furniture_shapes
from arena_core.values.obstacles import add_obstacles
from arena_core.values.rectangles import cover_with_rectangles
from arena_core.values.scene import Prism, Scene, furniture_scene, raise_footprints, scene_of, wall_boxes
from arena_core.values.sensing import camera_rays
from arena_core.values.world import free_area

__all__ = [
    "Door",
    "FurnitureKind",
    "Prism",
    "Scene",
    "add_furniture",
    "add_obstacles",
    "camera_rays",
    "close_doors",
    "cover_with_rectangles",
    "free_area",
    "furniture_kind",
    "furniture_of",
    "furniture_outlines",
    "furniture_scene",
    "furniture_shapes",
    "is_open",
    "raise_footprints",
    "scene_of",
    "wall_boxes",
]
