"""Metric packs and the report of the arena suite."""
