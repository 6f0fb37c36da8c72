"""Paths on the map, and waypoints on paths."""
