"""A*, waypoint generators, local costmap and localisers for the arena suite."""
