"""The solids of a world: furniture, walls, obstacles as polygons and prisms."""

from arena_core.config.furniture import furniture_kind
from arena_core.values.furniture import FurnitureKind, furnished, furniture_of, furniture_shapes, outlines
from arena_core.values.obstacles import with_obstacles
from arena_core.values.rectangles import rectangles
from arena_core.values.scene import Prism, Scene, furniture_scene, raised, scene_of, wall_boxes
from arena_core.values.sensing import camera_rays
from arena_core.values.world import free_area

__all__ = [
    "FurnitureKind",
    "Prism",
    "Scene",
    "camera_rays",
    "free_area",
    "furnished",
    "furniture_kind",
    "furniture_of",
    "furniture_scene",
    "furniture_shapes",
    "outlines",
    "raised",
    "rectangles",
    "scene_of",
    "wall_boxes",
    "with_obstacles",
]
