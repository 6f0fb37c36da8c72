"""Configuration groups of arena-robots."""
