"""Configuration groups of arena-metrics."""
