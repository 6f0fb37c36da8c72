"""Configuration groups of arena-tasks."""
