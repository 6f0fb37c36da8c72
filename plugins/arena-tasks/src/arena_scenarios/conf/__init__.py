"""Configuration groups of arena-worlds."""
